#pragma once
// Loads plans for the verbs of `dermis plan`: reads saved plans, and compiles graphs with the
// generic device profile.

#include "framegraph/serialize/plan_file.hpp"
#include "integration/tools/command/graph_input.hpp"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace dermis::tools {

struct PlanSource {
  std::string file;
  GraphInputs inputs;
  Size size = default_size;
  std::vector<NamedValue> settings;
  std::vector<std::string> unbound;
  bool two_queues = false;
};

struct NamedPlan {
  std::string name; // file and options
  bool from_graph = false;
  SavedPlan saved;
};

// Returns whether the file begins like a saved plan. Standard input ("-") is always a graph.
bool holds_plan(const std::string& path);

// Returns the bytes of a file of at most limits::file_bytes, or nullopt with an error in
// `diagnostics`.
std::optional<std::string> read_plan_bytes(const std::string& path, Diagnostics& diagnostics);

// Returns nullopt with errors in `diagnostics`, or with a usage error in `problem` for a name that
// the graph does not declare.
std::optional<NamedPlan> load_plan(const PlanSource& source, Diagnostics& diagnostics,
                                   std::string& problem);

} // namespace dermis::tools
