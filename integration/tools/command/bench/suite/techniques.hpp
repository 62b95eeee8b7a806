#pragma once
// Selects the techniques of a suite from its file.

#include "integration/tools/command/bench/suite/bench_file.hpp"
#include "integration/tools/command/bench/suite/suite.hpp"

#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace dermis::tools {

// "sap smooth"
std::string name_of(const TechniqueRequest& technique);
// Returns whether --techniques requests the technique and its graph exists; notes a missing graph.
bool is_usable(SuiteRun& run, const TechniqueRequest& technique);
// Returns whether --quick measures the technique: one of each kind.
bool is_one_of_few(std::string_view technique);
// The usage error that lists the scenes of a file.
demo::Error no_scene_selected(std::vector<std::string> known);
// The input error that none of these graphs exists.
demo::Error no_graph_exists(std::vector<std::string> graphs);

// Returns the usage error if a name of the option --`option` is not among `known`. The error lists
// `listed`, or `known` if it is empty.
demo::Result<> check_names(const SuiteRun& run, const std::string& option,
                           std::vector<std::string> known, std::vector<std::string> listed = {});

// Keeps the first setting of some techniques, for --quick.
template <class Request> void keep_few(std::vector<Request>& all) {
  std::set<std::string> seen;
  std::erase_if(all, [&](const Request& one) {
    return !is_one_of_few(one.technique) || !seen.insert(one.technique).second;
  });
}

// Returns the usage error if --techniques has an unknown name.
template <class Request>
demo::Result<> check_techniques(const SuiteRun& run, const std::vector<Request>& all) {
  std::vector<std::string> known;
  for (const Request& one : all)
    known.push_back(one.technique);
  return check_names(run, "techniques", std::move(known));
}

// Returns the usable techniques. Errors: usage (a name is unknown), input (no graph exists).
template <class Request>
demo::Result<std::vector<Request>> select_techniques(SuiteRun& run,
                                                     const std::vector<Request>& all) {
  std::vector<Request> selected;
  std::vector<std::string> missing;
  if (auto good = check_techniques(run, all); !good) return good.error();
  for (const Request& one : all)
    if (is_usable(run, one))
      selected.push_back(one);
    else if (run.is_requested("techniques", one.technique))
      missing.push_back(one.graph);
  if (selected.empty()) return no_graph_exists(std::move(missing));
  return selected;
}

} // namespace dermis::tools
