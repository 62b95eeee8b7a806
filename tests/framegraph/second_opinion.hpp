#pragma once
// Compares the verdicts of the verifier and the oracle.

#include "framegraph/compile/plan.hpp"

#include <cstdint>
#include <string>

namespace dermis::testing {

struct Tally {
  uint64_t tried = 0, rejected = 0;
};

// Counts the mutant as tried, and as rejected if the verifier rejects it. Adds a fatal failure to
// the running test if the oracle disagrees.
void expect_same_verdict(const Plan& mutant, const std::string& what, Tally& tally);

} // namespace dermis::testing
