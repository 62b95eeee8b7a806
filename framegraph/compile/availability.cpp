#include "framegraph/compile/availability.hpp"

#include <fmt/format.h>

namespace dermis {

MissingRequirements missing_requirements(const SettingDeclaration& setting, int64_t option,
                                         Features features, const std::vector<bool>& bound) {
  MissingRequirements unmet;
  if (option < 0 || static_cast<size_t>(option) >= setting.needs.size()) return unmet;
  const OptionNeeds& needs = setting.needs[static_cast<size_t>(option)];
  unmet.features = needs.features & ~features;
  for (const ResourceId import : needs.imports)
    if (!bound.empty() && !bound[import.value]) unmet.imports.push_back(import);
  return unmet;
}

SettingValue available_option(const SettingDeclaration& setting, const SettingValue& value,
                              Features features, const std::vector<bool>& bound) {
  const auto available = [&](int64_t option) {
    return !missing_requirements(setting, option, features, bound).any();
  };
  if (setting.needs.empty() || available(value.integer)) return value;
  if (available(setting.default_value.integer)) return setting.default_value;
  SettingValue instead = value;
  for (instead.integer = 0;
       !available(instead.integer);) // read_graph requires one option without needs
    ++instead.integer;
  return instead;
}

std::string missing_text(const Graph& graph, const MissingRequirements& unmet) {
  std::string text;
  for (uint32_t f = 0; f < static_cast<uint32_t>(Feature::count); ++f)
    if ((unmet.features & bit_of(static_cast<Feature>(f))) != 0)
      text += fmt::format("{}the device lacks {}, or it is not enabled", text.empty() ? "" : "; ",
                          feature_name(static_cast<Feature>(f)));
  for (const ResourceId import : unmet.imports)
    text += fmt::format("{}'{}' is not bound", text.empty() ? "" : "; ",
                        graph.resources[import.value].name);
  return text;
}

void report_unavailable(const Graph& graph, const DeviceProfile& device,
                        const std::vector<bool>& bound, Diagnostics& diagnostics) {
  for (const SettingDeclaration& setting : graph.settings)
    for (size_t option = 0; option < setting.needs.size(); ++option) {
      const MissingRequirements unmet =
          missing_requirements(setting, static_cast<int64_t>(option), device.features, bound);
      if (!unmet.any()) continue;
      diagnostics.add(DiagnosticId::option_unavailable, setting.where,
                      fmt::format("setting '{}' does not offer '{}': {}", setting.name,
                                  setting.options[option], missing_text(graph, unmet)));
    }
}

} // namespace dermis
