#pragma once
// Clock of the benchmarks.

#include <cstdint>

namespace dermis::tools {

// Returns the CPU time of the calling thread. Other programs affect it only through the caches.
uint64_t thread_nanoseconds();

} // namespace dermis::tools
