#pragma once
// Options of choices that need what a device may lack or the host may leave unbound: which of them are
// offered, and what runs instead of one that is not.

#include "framegraph/compile/device_profile.hpp"
#include "framegraph/model/graph.hpp"

#include <string>
#include <vector>

namespace dermis {

// Everything that the option lacks. `bound`: as in CompileInput. Free-threaded.
struct MissingRequirements {
  Features features = 0;
  std::vector<ResourceId> imports;

  bool any() const { return features != 0 || !imports.empty(); }
};
MissingRequirements missing_requirements(const SettingDeclaration& setting, int64_t option, Features features,
                                         const std::vector<bool>& bound);

// `value` where its option is offered; else the default, or the first option that is offered.
SettingValue available_option(const SettingDeclaration& setting, const SettingValue& value, Features features,
                              const std::vector<bool>& bound);

// "the device lacks ray_query; 'scene' is not bound". Free-threaded.
std::string missing_text(const Graph& graph, const MissingRequirements& unmet);

// A note for each option that is not offered. Free-threaded.
void report_unavailable(const Graph& graph, const DeviceProfile& device, const std::vector<bool>& bound,
                        Diagnostics& diagnostics);

} // namespace dermis
