#pragma once
// Runs the verifier on a saved plan.

#include "framegraph/text/diagnostic.hpp"

#include <cstddef>
#include <string>

namespace dermis::tools {

struct VerifiedPlan {
  std::string file;
  bool read = false;     // false: the file is not a plan of this version
  bool good = false;     // the verifier found no violation
  bool verified = false; // false: not read, or the verifier gave up
  size_t passes = 0, barriers = 0;
};

// Adds errors of the file and violations of the plan to `diagnostics`.
VerifiedPlan verify_plan_file(const std::string& file, Diagnostics& diagnostics);

// Returns one line without its end: the sizes of a plan that was read.
std::string describe(const VerifiedPlan& plan);

} // namespace dermis::tools
