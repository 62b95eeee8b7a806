#pragma once
// Checks that must hold before a plan can be simulated: indices are in range, intervals and memory
// are consistent.

#include "framegraph/compile/plan.hpp"

#include <string>
#include <vector>

namespace dermis {

// A hostile plan could cause one violation for each pair; the first ones are enough.
inline constexpr size_t max_violations = 32;

// Returns what is wrong with the structure of the plan, one sentence each. Empty: every index can
// be followed.
std::vector<std::string> verify_structure(const Plan& plan);

// Returns whether the two placements have a byte in common.
bool share_memory(const Placement& a, const Placement& b);

} // namespace dermis
