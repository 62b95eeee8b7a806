#pragma once
// Limits files: limits on the values of kernels and graphs, by device and driver.
//
//   { "dermis_kernel_limits": 1,
//     "rules": [
//       { "device": "*NAVI21*", "driver": "*Mesa 22.3*", "kernel": "*",
//         "max": { "spilled_vgprs": 0, "code_bytes": 16384 } },
//       { "device": "*NAVI21*", "kernel": "sap/*_down",
//         "max": { "spilled_vgprs": { "goal": 0, "now": 170 } }, "min": { "occupancy": 8 } },
//       { "graph": "sap", "max": { "dispatches": 14 } } ] }
//
// The last rule that matches a value decides. A limit with `goal` and `now` accepts values up to
// `now`, and is listed until the goal is reached.

#include "framegraph/text/document.hpp"
#include "integration/tools/command/kernels/graph_counts.hpp"
#include "integration/tools/command/kernels/rows.hpp"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace dermis::tools {

// Returns whether the whole text matches; '*' in the pattern matches any characters.
bool matches_pattern(std::string_view pattern, std::string_view text);

struct Limit {
  double goal = 0.0;
  double now = 0.0; // accepted; equal to the goal unless the file states both
  bool minimum = false;
  std::string key; // name of the value: "spilled_vgprs"
  SourceLocation where;
};

struct LimitRule {
  std::vector<std::string> devices, drivers; // patterns; empty: all
  bool of_graphs = false;                    // false: of kernels
  std::vector<std::string> names;            // patterns of kernels or graphs
  std::vector<Limit> limits;
};

// Returns nullopt with errors in `diagnostics`.
std::optional<std::vector<LimitRule>> read_limits(const Document& document,
                                                  Diagnostics& diagnostics);

struct LimitFinding {
  std::string subject; // "sap/subsurface_sap_up", "sap.json"
  std::string key;
  std::optional<double> value; // nullopt: the driver does not report it
  Limit limit;

  std::string text() const; // "sap/subsurface_sap_up: spilled_vgprs is 170, at most 0 is allowed"
};

struct LimitsCheck {
  bool device_known = false; // a rule is about this device and driver
  size_t checked = 0;        // number of values
  std::vector<LimitFinding> exceeded;
  std::vector<LimitFinding> open;  // within `now`, but the goal is not reached
  std::vector<LimitFinding> loose; // better than `now`, which can be tightened

  bool is_good() const { return device_known && checked > 0 && exceeded.empty(); }
};

struct LimitedDevice {
  std::string name, driver;
};

LimitsCheck check_limits(const std::vector<LimitRule>& rules, const LimitedDevice& device,
                         const std::vector<KernelRow>& kernels,
                         const std::vector<GraphCounts>& graphs);

} // namespace dermis::tools
