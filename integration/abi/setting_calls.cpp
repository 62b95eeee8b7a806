// Settings of a graph: listed for the host, and set by it.
#include "framegraph/model/expression.hpp"
#include "framegraph/model/frame_settings.hpp"
#include "integration/abi/graph.hpp"
#include "integration/abi/report.hpp"
#include "integration/abi/two_call.hpp"

#include <algorithm>

namespace dermis::abi {
namespace {

dermis_setting_type type_of(SettingType type) {
  switch (type) {
  case SettingType::boolean:
    return DERMIS_SETTING_BOOL;
  case SettingType::integer:
    return DERMIS_SETTING_INT;
  case SettingType::real:
    return DERMIS_SETTING_REAL;
  case SettingType::enumeration:
  case SettingType::choice:
    break;
  }
  return DERMIS_SETTING_OPTION;
}

double number_of(const SettingValue& value) {
  return value.type == SettingType::real ? value.real : static_cast<double>(value.integer);
}

bool is_set(const std::vector<HostSetting>& given, const std::string& name) {
  return std::any_of(given.begin(), given.end(), [&](const HostSetting& one) { return one.name == name; });
}

// The settings of the program that the view records next.
dermis_result get_settings(dermis_view_t& view, const char* function, uint32_t* count, dermis_setting* out) {
  const Log& log = view.context->log;
  const std::lock_guard changing(view.graph->changing);
  const std::shared_ptr<Program> kept = keep_newest(view);
  const Graph& graph = kept->graph;
  std::vector<SettingValue> values;
  {
    const std::lock_guard lock(view.mutex); // recording chooses an outcome
    values = kept->outcomes[kept->outcome].settings;
  }
  const std::vector<uint8_t> per_frame = frame_settings(graph, view.context->kinds);
  return fill_array(log, function, count, out, static_cast<uint32_t>(values.size()), [&](uint32_t i) {
    const SettingDeclaration& declared = graph.settings[i];
    dermis_setting setting = DERMIS_SETTING_INIT;
    setting.name = declared.name.c_str();
    setting.type = type_of(declared.type);
    setting.per_frame = per_frame[i];
    setting.unit = declared.unit.c_str();
    setting.note = declared.note.c_str();
    const bool ranged = declared.type == SettingType::integer || declared.type == SettingType::real;
    setting.minimum = ranged ? declared.minimum : 0;
    setting.maximum = ranged                                  ? declared.maximum
                      : declared.type == SettingType::boolean ? 1
                                                              : double(declared.options.size()) - 1;
    setting.default_value = number_of(declared.default_value);
    setting.value = number_of(values[i]);
    setting.set = is_set(view.graph->input.settings, declared.name) ? 1 : 0;
    setting.chosen = declared.by_budget && setting.set == 0 ? 1 : 0;
    setting.option_count = static_cast<uint32_t>(declared.options.size());
    setting.options = declared.options.empty() ? nullptr : kept->option_names[i].data();
    return setting;
  });
}

// Does a new value change which passes run?
bool changes_passes(const Program& program, const std::vector<SettingValue>& values) {
  for (const PassDeclaration& pass : program.graph.passes)
    if (pass.when.valid() &&
        evaluate(program.graph, pass.when, program.settings) != evaluate(program.graph, pass.when, values))
      return true;
  return false;
}

dermis_result set_setting(dermis_graph_t& graph, const std::string& name, const std::string& json,
                          dermis_report* report) {
  const Log& log = graph.context->log;
  const std::shared_ptr<Program> kept = keep_newest(graph.own);
  const Program& program = *kept;
  const auto& declared = program.graph.settings;
  const auto at = std::find_if(declared.begin(), declared.end(),
                               [&](const SettingDeclaration& setting) { return setting.name == name; });
  Diagnostics diagnostics;
  if (at == declared.end()) {
    std::string known;
    for (const SettingDeclaration& setting : declared)
      known += fmt::format("{}'{}'", known.empty() ? "" : ", ", setting.name);
    diagnostics.add(DiagnosticId::host_argument, {},
                    fmt::format("dermis_graph_set_setting: graph '{}' has no setting '{}'; it has {}",
                                program.graph.name, name, known.empty() ? "none" : known));
    return conclude(log, DERMIS_ERROR_ARGUMENT, std::move(diagnostics), report);
  }
  const auto value = read_setting(*at, json, diagnostics);
  if (!value) return conclude(log, DERMIS_ERROR_CONFIG, std::move(diagnostics), report);

  std::vector<SettingValue> values = program.settings;
  values[static_cast<size_t>(at - declared.begin())] = *value;
  ProgramInput input = graph.input;
  const auto given = std::find_if(input.settings.begin(), input.settings.end(),
                                  [&](const HostSetting& setting) { return setting.name == name; });
  if (given == input.settings.end())
    input.settings.push_back({name, json});
  else
    given->json = json;
  const auto index = static_cast<uint32_t>(at - declared.begin());
  if (at->by_budget || changes_passes(program, values))
    return replace_programs(graph, std::move(input), vulkan::HistoryReason::reloaded, report);
  std::vector<std::vector<choice::Outcome>> outcomes; // by view
  for_each_view(graph, [&](dermis_view_t& view) {
    const std::lock_guard lock(view.mutex);
    outcomes.push_back(outcomes_with(newest(view), view.chooser, graph.context->kinds, index, *value));
  });
  const dermis_result result = conclude(log, DERMIS_OK, std::move(diagnostics), report);
  if (result != DERMIS_OK) return result;
  size_t v = 0; // from here on nothing fails
  for_each_view(graph, [&](dermis_view_t& view) {
    const std::lock_guard lock(view.mutex);
    Program& changed = newest(view);
    changed.settings[index] = *value;
    changed.outcomes.swap(outcomes[v++]);
  });
  graph.input = std::move(input);
  return result;
}

} // namespace
} // namespace dermis::abi

using namespace dermis::abi;

extern "C" dermis_result DERMIS_CALL dermis_graph_settings(dermis_graph graph, uint32_t* count,
                                                           dermis_setting* settings) {
  constexpr const char* function = "dermis_graph_settings";
  if (graph == nullptr) return bad_argument({}, "{}: graph is NULL", function);
  return guarded(graph->context->log, function,
                 [&] { return get_settings(graph->own, function, count, settings); });
}

extern "C" dermis_result DERMIS_CALL dermis_graph_set_setting(dermis_graph graph, const char* name,
                                                              const char* json, dermis_report* report) {
  if (report != nullptr) *report = nullptr;
  if (graph == nullptr) return bad_argument({}, "dermis_graph_set_setting: graph is NULL");
  const Log& log = graph->context->log;
  return guarded(log, "dermis_graph_set_setting", [&] {
    if (name == nullptr) return bad_argument(log, "dermis_graph_set_setting: name is NULL");
    if (json == nullptr) return bad_argument(log, "dermis_graph_set_setting: json is NULL");
    if (const dermis_result alive = check_alive(*graph->context, "dermis_graph_set_setting");
        alive != DERMIS_OK)
      return alive;
    const std::lock_guard changing(graph->changing);
    return set_setting(*graph, name, json, report);
  });
}
