#pragma once
// The list of all suites. A new suite adds its function here and in suites.cpp.

#include "integration/tools/command/bench/suite/suite.hpp"

#include <string>
#include <vector>

namespace dermis::tools {

Suite record_suite();
Suite skip_suite();
Suite truth_suite();
Suite supplement_suite();
Suite compile_suite();
Suite stability_suite();
Suite budget_suite();
Suite error_time_suite();
Suite error_table_suite();
Suite dynamic_suite();
Suite restir_suite();

// Returns all suites, from the shortest run to the longest.
std::vector<Suite> bench_suites();
std::vector<std::string> bench_suite_names(); // "record", "skip", ...

} // namespace dermis::tools
