#include "framegraph/compile/offers.hpp"

#include <fmt/format.h>

namespace dermis {

Lacks lacks_of(const SettingDeclaration& setting, int64_t option, Features features,
               const std::vector<bool>& bound) {
  Lacks lacks;
  if (option < 0 || static_cast<size_t>(option) >= setting.needs.size()) return lacks;
  const OptionNeeds& needs = setting.needs[static_cast<size_t>(option)];
  lacks.features = needs.features & ~features;
  for (const ResourceId import : needs.imports)
    if (!bound.empty() && !bound[import.value]) lacks.imports.push_back(import);
  return lacks;
}

SettingValue offered_value(const SettingDeclaration& setting, const SettingValue& value, Features features,
                           const std::vector<bool>& bound) {
  const auto offered = [&](int64_t option) { return !lacks_of(setting, option, features, bound).any(); };
  if (setting.needs.empty() || offered(value.integer)) return value;
  if (offered(setting.default_value.integer)) return setting.default_value;
  SettingValue instead = value;
  for (instead.integer = 0; !offered(instead.integer);) // read_graph sees to it that one needs nothing
    ++instead.integer;
  return instead;
}

std::string lacks_text(const Graph& graph, const Lacks& lacks) {
  std::string text;
  for (uint32_t f = 0; f < static_cast<uint32_t>(Feature::count); ++f)
    if ((lacks.features & bit_of(static_cast<Feature>(f))) != 0)
      text += fmt::format("{}the device lacks {}, or it is not enabled", text.empty() ? "" : "; ",
                          feature_name(static_cast<Feature>(f)));
  for (const ResourceId import : lacks.imports)
    text += fmt::format("{}'{}' is not bound", text.empty() ? "" : "; ", graph.resources[import.value].name);
  return text;
}

void tell_withheld(const Graph& graph, const DeviceProfile& device, const std::vector<bool>& bound,
                   Diagnostics& diagnostics) {
  for (const SettingDeclaration& setting : graph.settings)
    for (size_t option = 0; option < setting.needs.size(); ++option) {
      const Lacks lacks = lacks_of(setting, static_cast<int64_t>(option), device.features, bound);
      if (!lacks.any()) continue;
      diagnostics.add(DiagnosticId::option_withheld, setting.where,
                      fmt::format("setting '{}' does not offer '{}': {}", setting.name,
                                  setting.options[option], lacks_text(graph, lacks)));
    }
}

} // namespace dermis
