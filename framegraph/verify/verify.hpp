#pragma once
// Checks a plan independently of the compiler: a happens-before model that reads only the plan,
// sharing no code with compile/. An accepted plan has no hazard that the model can express;
// subresources.hpp lists the rules.

#include "framegraph/compile/plan.hpp"

#include <string>
#include <vector>

namespace dermis {

struct Verdict {
  std::vector<std::string> violations; // hazards, one sentence each, in execution order
  std::string not_verified;            // why the check ended early; "": it is complete

  // Returns whether the check was complete and found no hazard.
  bool proven() const { return violations.empty() && not_verified.empty(); }
};

// Simulates enough consecutive frames for every history instance to have played every role.
// Stricter than Vulkan in one point: a barrier orders only accesses to the memory it names, so each
// dependency must be stated where it is needed. Time is proportional to the number of passes,
// accesses and barriers; the check gives up on plans that need far longer (Verdict::not_verified).
// Free-threaded. Safe for any plan, including plans with indices out of range.
Verdict verify(const Plan& plan);

} // namespace dermis
