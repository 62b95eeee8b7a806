#include "integration/tools/command/bench/suite/suites.hpp"

namespace dermis::tools {

std::vector<Suite> bench_suites() {
  return {record_suite(),      skip_suite(),      truth_suite(),  supplement_suite(),
          compile_suite(),     stability_suite(), budget_suite(), error_time_suite(),
          error_table_suite(), dynamic_suite(),   restir_suite()};
}

std::vector<std::string> bench_suite_names() {
  std::vector<std::string> names;
  for (const Suite& suite : bench_suites())
    names.push_back(suite.name);
  return names;
}

} // namespace dermis::tools
