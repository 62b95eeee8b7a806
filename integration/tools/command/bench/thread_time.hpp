#pragma once
// The clock of the benchmarks.

#include <cstdint>

namespace dermis::tools {

// CPU time of the calling thread: other programs on the machine do not count, except through the caches.
uint64_t thread_nanoseconds();

} // namespace dermis::tools
