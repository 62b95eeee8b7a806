#pragma once
// An independent check of a plan: a happens-before model of its own over the plan alone, sharing no code with
// compile/. A plan it accepts has no hazard that the model can express; see the list in verify.cpp.

#include "framegraph/compile/plan.hpp"

#include <string>
#include <vector>

namespace dermis {

struct Verdict {
  std::vector<std::string> violations; // hazards, one sentence each, in the order in which they would happen
  std::string not_verified;            // why the check ended before it was complete; "": it is complete

  // No hazard, and nothing left to check.
  bool proven() const { return violations.empty() && not_verified.empty(); }
};

// Runs the plan over enough consecutive frames for every history instance to have played every role. Stricter
// than Vulkan in one point: a barrier orders only accesses to the memory it names, so that each dependency is
// stated where it is needed. Takes time in proportion to passes, accesses and barriers; gives up where a plan
// is made so that it would take far longer. Free-threaded. Safe on any plan, also one with indices out of
// range.
Verdict verify(const Plan& plan);

} // namespace dermis
