#pragma once
// What a file `name.expect.json` beside the graph `name.json` states: for given inputs, what the compiler
// must make of the graph. Format: docs/expectations.md.

#include "framegraph/model/vocabulary.hpp"
#include "framegraph/text/document.hpp"
#include "integration/tools/command/verbs.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace dermis::tools {

// What compiling made, or is stated to make. Absent: not stated, or there is no plan.
struct MachineInfo {
  std::optional<std::vector<std::string>> passes;           // names, in the order in which they run
  std::optional<std::map<std::string, std::string>> culled; // name of the pass, why
  std::optional<uint64_t> barriers, batches;                // memory dependencies; commands that hold them
  std::optional<uint64_t> transient_bytes, history_bytes;   // of heaps
  std::vector<std::string> diagnostics;                     // codes ("D0303"), in order of discovery

  bool operator==(const MachineInfo&) const = default;
};

struct ExpectedCase {
  std::string name;
  Size size;
  std::vector<std::string> overlays; // names of files, applied in this order
  std::vector<NamedValue> settings;
  std::vector<std::string> unbound; // optional imports and exports
  std::map<std::string, Format> host_formats;
  std::vector<Format> unsupported_formats; // of the device
  Features unmet = 0;                      // the device
  std::optional<uint32_t> max_image_dimension;
  std::optional<MachineInfo> info; // absent: nothing is stated yet
  NodeId node, info_node;          // of the case; of its "expect", invalid if there is none
};

// The cases of an expectation file, or nullopt with errors in `diagnostics`.
std::optional<std::vector<ExpectedCase>> read_expectations(const Document& document,
                                                           Diagnostics& diagnostics);

// The facts of `observed` that `stated` speaks of. Diagnostics are always spoken of: none stated, none
// expected.
MachineInfo narrow(const MachineInfo& observed, const MachineInfo& stated);

// As written under "expect".
std::string info_json(const MachineInfo& info);

// `text`, which `document` was read from, with the facts of each case replaced where `facts` has some (one
// entry a case). Everything else stays as it is, comments included.
std::string rewrite_info(const Document& document, const std::string& text,
                         const std::vector<ExpectedCase>& cases,
                         const std::vector<std::optional<MachineInfo>>& info);

} // namespace dermis::tools
