#pragma once
// --quick of the suites: small pictures, few repetitions and, of what takes long, few scenes or techniques.
// It shows that everything runs and how its pages look; its figures say nothing.

#include "integration/tools/command/bench/dynamic/dynamic_file.hpp"
#include "integration/tools/command/bench/plan_file.hpp"
#include "integration/tools/command/bench/restir/restir_file.hpp"
#include "integration/tools/command/bench/truth/truth_file.hpp"
#include "integration/tools/command/verbs.hpp"

#include <string>
#include <utility>
#include <vector>

namespace dermis::tools {

// As asked for, or smaller where it is to be quick.
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
void quicken(std::vector<TechniqueRequest>& techniques); // the first setting of some

// What pages and rows of such a run say of themselves.
std::pair<std::string, std::string> quick_fact();

} // namespace dermis::tools
