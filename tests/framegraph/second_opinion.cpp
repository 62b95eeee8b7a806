#include "tests/framegraph/second_opinion.hpp"

#include "tests/framegraph/hazard_oracle.hpp"

#include "framegraph/verify/verify.hpp"

#include <gtest/gtest.h>

namespace dermis::testing {

void expect_same_verdict(const Plan& mutant, const std::string& what, Tally& tally) {
  const auto violations = verify(mutant).violations;
  const std::string hazard = first_hazard(mutant);
  ++tally.tried;
  tally.rejected += !violations.empty();
  ASSERT_EQ(violations.empty(), hazard.empty())
      << what << "\nverifier: " << (violations.empty() ? "accepts" : violations.front())
      << "\noracle: " << (hazard.empty() ? "accepts" : hazard);
}

} // namespace dermis::testing
