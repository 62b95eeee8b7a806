#pragma once
// Reduces suites for --quick: small images, few repetitions and, in long suites, few scenes or
// techniques. A quick run is a smoke test of the suites and their pages; its figures are
// meaningless.

#include "integration/tools/command/bench/dynamic/dynamic_file.hpp"
#include "integration/tools/command/bench/plan_file.hpp"
#include "integration/tools/command/bench/restir/restir_file.hpp"
#include "integration/tools/command/bench/truth/truth_file.hpp"
#include "integration/tools/command/verbs.hpp"

#include <string>
#include <utility>
#include <vector>

namespace dermis::tools {

// Returns the options unchanged, or reduced if `quick` is set.
BenchErrorTimeOptions quickened(BenchErrorTimeOptions options);
BenchDynamicOptions quickened(BenchDynamicOptions options);
BenchStabilityOptions quickened(BenchStabilityOptions options);
BenchBudgetOptions quickened(BenchBudgetOptions options);
BenchSkipOptions quickened(BenchSkipOptions options);
BenchRestirOptions quickened(BenchRestirOptions options);
void quicken(ErrorTimeFile& file);
void quicken(DynamicFile& file);
void quicken(PropertyFile& file);
void quicken(RestirFile& file);
// keeps the first setting of some techniques
void quicken(std::vector<TechniqueRequest>& techniques);

// Returns a fact for reports that marks a quick run.
std::pair<std::string, std::string> quick_fact();

} // namespace dermis::tools
