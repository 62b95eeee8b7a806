#pragma once
// Counts what a thread allocates with operator new, which this program replaces.

#include <cstdint>

namespace dermis::testing {

uint64_t allocations_of_this_thread();

} // namespace dermis::testing
