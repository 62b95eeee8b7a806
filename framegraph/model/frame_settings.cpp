#include "framegraph/model/frame_settings.hpp"

namespace dermis {

std::vector<uint8_t> frame_settings(const Graph& graph, const PassTypeRegistry& pass_types) {
  std::vector<uint8_t> followed(graph.settings.size(), 0), fixed(graph.settings.size(), 0);
  for (const PassDeclaration& pass : graph.passes)
    for (const SettingBinding& binding : pass.settings) {
      if (!binding.from.valid()) continue;
      followed[binding.from.value] = 1;
      if (!pass_types[pass.type].settings[binding.setting].per_frame) fixed[binding.from.value] = 1;
    }
  for (const Expression& expression : graph.expressions)
    if (expression.op == Expression::Op::setting) fixed[expression.setting.value] = 1;
  for (size_t i = 0; i < graph.settings.size(); ++i)
    followed[i] = followed[i] != 0 && fixed[i] == 0 && !graph.settings[i].by_budget ? 1 : 0;
  return followed;
}

bool selects_formats(const Graph& graph, const PassTypeRegistry& pass_types, SettingId setting) {
  for (const PassDeclaration& pass : graph.passes) {
    const PassType& type = pass_types[pass.type];
    for (const SettingBinding& binding : pass.settings) {
      if (!binding.from.valid() || binding.from.value != setting.value) continue;
      const std::string_view name = type.settings[binding.setting].name;
      for (const Port& port : type.ports)
        if (port.formats_while.setting == name) return true;
    }
  }
  return false;
}

bool selects_pipelines(const Graph& graph, const PassTypeRegistry& pass_types, SettingId setting) {
  for (const PassDeclaration& pass : graph.passes)
    for (const SettingBinding& binding : pass.settings)
      if (binding.from.valid() && binding.from.value == setting.value &&
          is_constant(pass_types[pass.type].settings[binding.setting]))
        return true;
  return false;
}

} // namespace dermis
