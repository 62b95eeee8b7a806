#pragma once
// An independent, slow checker of plans. It compares every pair of operations of several frames on
// memory with a common byte, and follows each pair through every barrier between them. It shares no
// code and no state with the verifier, and carries nothing from one operation to the next.

#include "framegraph/compile/plan.hpp"

#include <string>

namespace dermis::testing {

// Returns a text for the first hazard, or "" if there is none. Indices of the plan must be in
// range.
std::string first_hazard(const Plan& plan);

} // namespace dermis::testing
