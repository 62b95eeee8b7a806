#include "tests/framegraph/second_opinion.hpp"

#include "tests/framegraph/hazard_oracle.hpp"

#include "framegraph/verify/verify.hpp"

#include <gtest/gtest.h>

namespace dermis::testing {

void expect_same_verdict(const Plan& mutant, const std::string& what, Tally& tally) {
  const auto objections = verify(mutant).objections;
  const std::string hazard = first_hazard(mutant);
  ++tally.tried;
  tally.refused += !objections.empty();
  ASSERT_EQ(objections.empty(), hazard.empty())
      << what << "\nverifier: " << (objections.empty() ? "accepts" : objections.front())
      << "\noracle: " << (hazard.empty() ? "accepts" : hazard);
}

} // namespace dermis::testing
