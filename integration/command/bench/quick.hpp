#pragma once
// --quick of the suites: small pictures and few repetitions, with every row that the whole suite has. It
// shows that everything runs and how its pages look; its figures say nothing.

#include "integration/command/bench/dynamic/dynamic_file.hpp"
#include "integration/command/bench/plan_file.hpp"
#include "integration/command/verbs.hpp"

#include <string>
#include <utility>

namespace dermis::tools {

// As asked for, or smaller where it is to be quick.
BenchErrorTimeOptions quickened(BenchErrorTimeOptions options);
BenchDynamicOptions quickened(BenchDynamicOptions options);
BenchStabilityOptions quickened(BenchStabilityOptions options);
BenchBudgetOptions quickened(BenchBudgetOptions options);
BenchSkipOptions quickened(BenchSkipOptions options);
void quicken(ErrorTimeFile& file);
void quicken(DynamicFile& file);

// What pages and rows of such a run say of themselves.
std::pair<std::string, std::string> quick_fact();

} // namespace dermis::tools
