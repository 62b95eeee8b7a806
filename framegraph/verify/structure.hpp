#pragma once
// What must hold for a plan before it can be run in thought: indices in range, intervals and memory
// consistent.

#include "framegraph/compile/plan.hpp"

#include <string>
#include <vector>

namespace dermis {

inline constexpr size_t max_violations =
    32; // the first ones tell; a hostile plan could cause one for each pair

// What is wrong with the shape of the plan, one sentence each; empty: every index can be followed.
std::vector<std::string> verify_structure(const Plan& plan);

// Do the two placements have a byte in common?
bool share_memory(const Placement& a, const Placement& b);

} // namespace dermis
