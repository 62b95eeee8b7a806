#pragma once
// Counts allocations per thread. Programs that link this file replace operator new by a counting
// version.

#include <cstdint>

namespace dermis::tools {

// Returns the number of calls of operator new on the calling thread, including calls from shared
// libraries.
uint64_t allocations_of_this_thread();

} // namespace dermis::tools
