#pragma once
// Expectations of a graph: a file `name.expect.json` next to the graph `name.json` states the
// result of compiling it for given inputs. Format: docs/expectations.md.

#include "framegraph/model/vocabulary.hpp"
#include "framegraph/text/document.hpp"
#include "integration/tools/command/verbs.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace dermis::tools {

// The result of a compilation, observed or stated. An absent member is not stated, or there is no
// plan.
struct MachineInfo {
  std::optional<std::vector<std::string>> passes;           // names, in execution order
  std::optional<std::map<std::string, std::string>> culled; // pass name to reason
  // memory dependencies, and the commands that contain them
  std::optional<uint64_t> barriers, batches;
  std::optional<uint64_t> transient_bytes, history_bytes; // size of the heaps, bytes
  std::vector<std::string> diagnostics;                   // codes ("D0303"), in order of discovery

  bool operator==(const MachineInfo&) const = default;
};

struct ExpectedCase {
  std::string name;
  Size size;
  std::vector<std::string> overlays; // file names, applied in this order
  std::vector<NamedValue> settings;
  std::vector<std::string> unbound; // optional imports and exports
  std::map<std::string, Format> host_formats;
  std::vector<Format> unsupported_formats; // that the device lacks
  Features unmet = 0;                      // features that the device lacks
  std::optional<uint32_t> max_image_dimension;
  std::optional<MachineInfo> info; // absent: not stated yet
  NodeId node, info_node;          // of the case; of its "expect", invalid if absent
};

// Returns the cases of an expectation file, or nullopt with errors in `diagnostics`.
std::optional<std::vector<ExpectedCase>> read_expectations(const Document& document,
                                                           Diagnostics& diagnostics);

// Returns the members of `observed` that `stated` states. Diagnostics are always compared: none
// stated means none expected.
MachineInfo narrow(const MachineInfo& observed, const MachineInfo& stated);

// Formats the value of "expect".
std::string info_json(const MachineInfo& info);

// Returns `text`, which is the source of `document`, with "expect" replaced in each case that has
// an entry in `info` (one entry per case). All other bytes stay unchanged, including comments.
std::string rewrite_info(const Document& document, const std::string& text,
                         const std::vector<ExpectedCase>& cases,
                         const std::vector<std::optional<MachineInfo>>& info);

} // namespace dermis::tools
