#pragma once
// Plans for the verbs of `dermis plan`: saved ones read, graphs compiled with the generic device profile.

#include "framegraph/serial/plan_file.hpp"
#include "integration/tools/command/graph_input.hpp"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace dermis::tools {

struct PlanSource {
  std::string file;
  GraphParts parts;
  Size size = default_size;
  std::vector<NamedValue> settings;
  std::vector<std::string> unbound;
  bool two_queues = false;
};

struct NamedPlan {
  std::string name; // file, and what was asked of it
  bool from_graph = false;
  SavedPlan saved;
};

// The bytes of a file of at most limits::file_bytes; nullopt with an error in `diagnostics`.
std::optional<std::string> read_plan_bytes(const std::string& path, Diagnostics& diagnostics);

// nullopt with errors in `diagnostics`, or a usage error in `problem`: a name that the graph does not have.
std::optional<NamedPlan> load_plan(const PlanSource& source, Diagnostics& diagnostics, std::string& problem);

} // namespace dermis::tools
