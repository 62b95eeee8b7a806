#pragma once
// Compiles the kernels of graphs on a device that only compiles, and counts what their plans do.

#include "integration/examples/demo_engine/result.hpp"
#include "integration/tools/command/kernels/graph_counts.hpp"
#include "integration/tools/command/kernels/rows.hpp"
#include "integration/tools/command/verbs.hpp"
#include "passes/choice/configurations.hpp"

namespace dermis::tools {

struct SkippedGraph {
  std::string graph, why;
};

// Kinds of work as calibrations name them, over all configurations of all graphs.
struct WorkRow {
  std::string work, kernel;
  choice::PassLoad load;
  uint64_t groups = 0; // for a load that the view or the plan determines; else 0
  PassTraffic traffic;
};

struct KernelSurvey {
  std::string device, driver;
  bool statistics = false; // the driver reports values of kernels
  std::vector<KernelRow> kernels;
  std::vector<GraphCounts> graphs;
  std::vector<WorkRow> works; // sorted by name
  std::vector<SkippedGraph> skipped;
};

// Surveys the graphs of `options`. Errors: input (a graph cannot be used; `diagnostics` says why),
// environment (no device), usage (unknown setting or slot).
demo::Result<KernelSurvey> survey_kernels(const KernelsOptions& options, const Session& session,
                                          Diagnostics& diagnostics);

} // namespace dermis::tools
