#pragma once
// An independent check of a plan: a happens-before model of its own over the plan alone, sharing no code with
// compile/. A plan it accepts has no hazard that the model can express; see the list in verify.cpp.

#include "framegraph/compile/plan.hpp"

#include <string>
#include <vector>

namespace dermis {

// What is wrong with the plan, one sentence each, in the order it would happen; empty if nothing is. Runs the
// plan over enough consecutive frames for every history instance to have played every role. Stricter than
// Vulkan in one point: a barrier orders only accesses to the memory it names, so that each dependency is
// stated where it is needed. Free-threaded. Safe on any plan, also one with indices out of range.
std::vector<std::string> verify(const Plan& plan);

} // namespace dermis
