#pragma once
// The verifier and the oracle side by side.

#include "framegraph/compile/plan.hpp"

#include <cstdint>
#include <string>

namespace dermis::testing {

struct Tally {
  uint64_t tried = 0, refused = 0;
};

// Counts whether the verifier refuses `mutant`; a fatal failure of the running test if the oracle disagrees.
void expect_same_verdict(const Plan& mutant, const std::string& what, Tally& tally);

} // namespace dermis::testing
