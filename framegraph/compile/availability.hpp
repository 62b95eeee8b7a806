#pragma once
// Availability of options: an option of a setting may need device features or imports that the host
// binds.

#include "framegraph/compile/device_profile.hpp"
#include "framegraph/model/graph.hpp"

#include <string>
#include <vector>

namespace dermis {

// The requirements that an option lacks. `bound`: as in CompileInput. Free-threaded.
struct MissingRequirements {
  Features features = 0;
  std::vector<ResourceId> imports;

  bool any() const { return features != 0 || !imports.empty(); }
};
MissingRequirements missing_requirements(const SettingDeclaration& setting, int64_t option,
                                         Features features, const std::vector<bool>& bound);

// Returns `value` if its option is available; else the default, or the first available option.
SettingValue available_option(const SettingDeclaration& setting, const SettingValue& value,
                              Features features, const std::vector<bool>& bound);

// Returns a text such as "the device lacks ray_query; 'scene' is not bound". Free-threaded.
std::string missing_text(const Graph& graph, const MissingRequirements& unmet);

// Adds a note for each option that is not available. Free-threaded.
void report_unavailable(const Graph& graph, const DeviceProfile& device,
                        const std::vector<bool>& bound, Diagnostics& diagnostics);

} // namespace dermis
