#pragma once
// A second opinion on plans, slow and plain: looks at every pair of operations of several frames on memory
// with a byte in common, and for each pair again at every barrier between them. Shares no code with the
// verifier, nor its state: nothing is carried from one operation to the next.

#include "framegraph/compile/plan.hpp"

#include <string>

namespace dermis::testing {

// The first hazard, in words; "" if there is none. Indices of the plan must be in range.
std::string first_hazard(const Plan& plan);

} // namespace dermis::testing
