#pragma once
// Plans changed by hand, for tests that ask who notices.

#include "framegraph/compile/plan.hpp"

namespace dermis::testing {

Plan without_barrier(const Plan& plan, uint32_t index);

// Every placement in memory of its own.
Plan without_aliasing(const Plan& plan);

} // namespace dermis::testing
