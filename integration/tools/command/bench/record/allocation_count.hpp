#pragma once
// Counts what a thread allocates: programs that link this replace operator new by one that counts.

#include <cstdint>

namespace dermis::tools {

// Calls of operator new on the calling thread since it began, those of shared libraries included.
uint64_t allocations_of_this_thread();

} // namespace dermis::tools
