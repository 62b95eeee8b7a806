// Lists and changes settings of a graph.
#include "framegraph/compile/availability.hpp"
#include "framegraph/model/expression.hpp"
#include "framegraph/model/frame_settings.hpp"
#include "integration/abi/graph.hpp"
#include "integration/abi/host_pass_types.hpp"
#include "integration/abi/report.hpp"
#include "integration/abi/slots.hpp"
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

// Returns whether the host set a value that applies. A value that a reload did not carry over is
// kept, for a later graph that accepts it.
bool is_set(const std::vector<HostSetting>& given, const SettingDeclaration& declared) {
  return std::any_of(given.begin(), given.end(), [&](const HostSetting& one) {
    Diagnostics scratch; // reported when the graph was created
    return one.name == declared.name && read_setting(declared, one.json, scratch);
  });
}
bool has_own(const dermis_view_t& view, const CompiledGraph& compiled_graph, uint32_t setting) {
  return is_set(view.settings, compiled_graph.graph.settings[setting]) &&
         frame_settings(compiled_graph.graph, view.context->pass_types)[setting] != 0;
}

// Returns the settings of the compiled graph that the view will record next.
dermis_result get_settings(dermis_view_t& view, const char* function, uint32_t* count,
                           dermis_setting* out) {
  const Log& log = view.context->log;
  const std::lock_guard changing(view.graph->changing);
  const std::shared_ptr<CompiledGraph> kept = keep_newest(view);
  const Graph& graph = kept->graph;
  std::vector<SettingValue> values;
  {
    const std::lock_guard lock(view.mutex); // recording chooses a configuration
    values = kept->configurations[kept->configuration].settings;
  }
  const std::vector<uint8_t> per_frame = frame_settings(graph, view.context->pass_types);
  return fill_array(
      log, function, count, out, static_cast<uint32_t>(values.size()), [&](uint32_t i) {
        const SettingDeclaration& declared = graph.settings[i];
        dermis_setting setting = DERMIS_SETTING_INIT;
        setting.name = declared.name.c_str();
        setting.type = type_of(declared.type);
        setting.per_frame = per_frame[i];
        setting.unit = declared.unit.c_str();
        setting.note = declared.note.c_str();
        const bool ranged =
            declared.type == SettingType::integer || declared.type == SettingType::real;
        setting.minimum = ranged ? declared.minimum : 0;
        setting.maximum = ranged ? declared.maximum
                          : declared.type == SettingType::boolean
                              ? 1
                              : double(declared.options.size()) - 1;
        setting.default_value = number_of(declared.default_value);
        setting.value = number_of(values[i]);
        setting.set = per_frame[i] != 0 && is_set(view.settings, declared) ? 2
                      : is_set(view.graph->input.settings, declared)       ? 1
                                                                           : 0;
        setting.chosen = declared.by_budget && setting.set == 0 ? 1 : 0;
        setting.option_count = static_cast<uint32_t>(declared.options.size());
        setting.options = declared.options.empty() ? nullptr : kept->option_names[i].data();
        return setting;
      });
}

auto find_declared(const Graph& graph, const std::string& name) {
  return std::find_if(graph.settings.begin(), graph.settings.end(),
                      [&](const SettingDeclaration& setting) { return setting.name == name; });
}

void add_unknown(const char* function, const Graph& graph, const std::string& name,
                 Diagnostics& diagnostics) {
  std::string known;
  for (const SettingDeclaration& setting : graph.settings)
    known += fmt::format("{}'{}'", known.empty() ? "" : ", ", setting.name);
  diagnostics.add(DiagnosticId::host_argument, {},
                  fmt::format("{}: graph '{}' has no setting '{}'; it has {}", function, graph.name,
                              name, known.empty() ? "none" : known));
}

void set_in(std::vector<HostSetting>& given, const std::string& name, const std::string& json) {
  const auto at = std::find_if(given.begin(), given.end(),
                               [&](const HostSetting& setting) { return setting.name == name; });
  if (at == given.end())
    given.push_back({name, json});
  else
    at->json = json;
}

bool remove_from(std::vector<HostSetting>& given, const std::string& name) {
  return std::erase_if(given, [&](const HostSetting& one) { return one.name == name; }) > 0;
}

// Returns what runs for a value: the value, unless its option needs what is missing, as in
// dermis_graph_create.
SettingValue offered_value(const dermis_graph_t& graph, const Graph& compiled,
                           const SettingDeclaration& setting, const SettingValue& value,
                           Diagnostics& diagnostics) {
  if (setting.needs.empty()) return value;
  const Features features = graph.context->profile.features;
  Diagnostics scratch; // reported when the graph was created
  const std::vector<bool> bound = bound_resources(compiled, graph.input.unbound, scratch);
  const auto missing = missing_requirements(setting, value.integer, features, bound);
  if (!missing.any()) return value;
  const SettingValue instead = available_option(setting, value, features, bound);
  diagnostics.add(DiagnosticId::option_unavailable, setting.where,
                  fmt::format("setting '{}' does not offer '{}': {}; '{}' runs instead",
                              setting.name, setting.options[static_cast<size_t>(value.integer)],
                              missing_text(compiled, missing),
                              setting.options[static_cast<size_t>(instead.integer)]));
  return instead;
}

// Returns the value that applies to views without their own.
SettingValue value_of_graph(const dermis_graph_t& graph, const Graph& compiled,
                            const SettingDeclaration& declared) {
  const auto& given = graph.input.settings;
  const auto at = std::find_if(given.begin(), given.end(), [&](const HostSetting& setting) {
    return setting.name == declared.name;
  });
  Diagnostics scratch; // the value was accepted before
  const auto value =
      at != given.end() ? read_setting(declared, at->json, scratch) : std::optional<SettingValue>();
  return offered_value(graph, compiled, declared, value.value_or(declared.default_value), scratch);
}

// Returns whether a new value of the setting changes which passes run, with any values of the
// choices that are made by budget.
bool changes_passes(const CompiledGraph& compiled_graph, const std::vector<HostSetting>& given,
                    SettingId setting, const SettingValue& value) {
  const Graph& graph = compiled_graph.graph;
  PartialValues before;
  for (uint32_t i = 0; i < graph.settings.size(); ++i) {
    const SettingDeclaration& declared = graph.settings[i];
    const bool open = declared.by_budget && !is_set(given, declared);
    before.push_back(open ? std::nullopt : std::optional(compiled_graph.settings[i]));
  }
  PartialValues after = before;
  after[setting.value] = value;
  for (const PassDeclaration& pass : graph.passes) {
    if (!pass.when.valid() || !reads_setting(graph, pass.when, setting)) continue;
    const std::optional<bool> ran = evaluate_partly(graph, pass.when, before),
                              runs = evaluate_partly(graph, pass.when, after);
    if (ran != runs || !ran) return true; // unknown: some choice may make a difference
  }
  return false;
}

bool changes_plans(const CompiledGraph& compiled_graph, const PassTypeRegistry& pass_types,
                   const std::vector<HostSetting>& given, SettingId setting,
                   const SettingValue& value) {
  if (compiled_graph.graph.settings[setting.value].by_budget) return true;
  if (compiled_graph.settings[setting.value] == value) return false;
  return changes_passes(compiled_graph, given, setting, value) ||
         selects_formats(compiled_graph.graph, pass_types, setting);
}

// A new value of a setting in one view.
struct ViewChange {
  dermis_view_t* view = nullptr;
  std::vector<choice::Configuration> configurations;
  NewPipelines pipelines; // empty: those of before
};

// Makes the view run with a new value of the setting. Frames that were recorded before tell about
// the new configurations only if these are the same work.
void adopt_value(CompiledGraph& changed, uint32_t setting, const SettingValue& value,
                 std::vector<choice::Configuration>& configurations) noexcept {
  if (!std::ranges::equal(changed.configurations, configurations, choice::is_same_work))
    ++changed.revision;
  changed.settings[setting] = value;
  changed.configurations.swap(configurations);
}

// `json` NULL: the default applies again, and a choice is made by the budget again.
dermis_result set_setting(dermis_graph_t& graph, const std::string& name, const char* json,
                          dermis_report* report) {
  const Log& log = graph.context->log;
  const std::shared_ptr<CompiledGraph> kept = keep_newest(graph.own);
  const CompiledGraph& compiled_graph = *kept;
  const auto& declared = compiled_graph.graph.settings;
  Diagnostics diagnostics;
  const auto at = find_declared(compiled_graph.graph, name);
  CompiledGraphInput input = graph.input;
  const bool removed = json == nullptr && remove_from(input.settings, name);
  if (at == declared.end() && removed) { // a reload did not carry it over
    graph.input = std::move(input);
    return conclude(log, DERMIS_OK, std::move(diagnostics), report);
  }
  if (at == declared.end()) {
    add_unknown("dermis_graph_set_setting", compiled_graph.graph, name, diagnostics);
    return conclude(log, DERMIS_ERROR_ARGUMENT, std::move(diagnostics), report);
  }
  const auto given = json != nullptr ? read_setting(*at, json, diagnostics) : at->default_value;
  if (!given) return conclude(log, DERMIS_ERROR_CONFIG, std::move(diagnostics), report);
  const SettingValue value = offered_value(graph, compiled_graph.graph, *at, *given, diagnostics);
  if (json != nullptr) set_in(input.settings, name, json);
  const auto index = static_cast<uint32_t>(at - declared.begin());
  if (changes_plans(compiled_graph, graph.context->pass_types, graph.input.settings, {index},
                    value))
    return replace_compiled_graphs(graph, std::move(input), vulkan::HistoryReason::reloaded,
                                   report);
  std::vector<ViewChange> changes; // of views without their own value
  for_each_view(graph, [&](dermis_view_t& view) {
    const std::lock_guard lock(view.mutex);
    if (has_own(view, newest(view), index)) return;
    changes.push_back({&view,
                       configurations_with(newest(view), graph.context->pass_types,
                                           view.chooser.errors, view.chooser.costs, index, value),
                       {}});
  });
  vulkan::KernelStore kernels(graph.context->kernels);
  if (selects_pipelines(compiled_graph.graph, graph.context->pass_types, {index})) {
    for (ViewChange& change : changes)
      if (const vulkan::Error error =
              make_pipelines(*graph.context, graph.input, *keep_newest(*change.view),
                             change.configurations, kernels, change.pipelines)) {
        const dermis_result failed = rejected(*graph.context, error, diagnostics);
        return conclude(log, failed, std::move(diagnostics), report);
      }
  }
  const dermis_result result = conclude(log, DERMIS_OK, std::move(diagnostics), report);
  if (result != DERMIS_OK) return result;
  kernels.hand_over();
  for (ViewChange& change : changes) { // nothing fails from here on
    const std::lock_guard lock(change.view->mutex);
    CompiledGraph& changed = newest(*change.view);
    adopt_value(changed, index, value, change.configurations);
    retire_other_costs(change.view->chooser, changed);
    for (size_t p = 0; p < change.pipelines.size(); ++p)
      changed.plans[p].executor->set_pipelines(change.pipelines[p]);
  }
  graph.input = std::move(input);
  return result;
}

// Sets the view's own value. `json` NULL: the graph's value applies again.
dermis_result set_view_setting(dermis_view_t& view, const std::string& name, const char* json,
                               dermis_report* report) {
  constexpr const char* function = "dermis_view_set_setting";
  const Log& log = view.context->log;
  const std::lock_guard changing(view.graph->changing);
  const std::shared_ptr<CompiledGraph> kept = keep_newest(view);
  const Graph& graph = kept->graph;
  Diagnostics diagnostics;
  const auto at = find_declared(graph, name);
  const std::vector<uint8_t> per_frame = frame_settings(graph, view.context->pass_types);
  const auto index = static_cast<uint32_t>(at - graph.settings.begin());
  const bool applies = at != graph.settings.end() && per_frame[index] != 0;
  // a value that a reload did not carry over can be removed
  if (!applies && json == nullptr && remove_from(view.settings, name))
    return conclude(log, DERMIS_OK, std::move(diagnostics), report);
  if (at == graph.settings.end()) {
    add_unknown(function, graph, name, diagnostics);
    return conclude(log, DERMIS_ERROR_ARGUMENT, std::move(diagnostics), report);
  }
  if (!applies) {
    std::string own;
    for (size_t i = 0; i < graph.settings.size(); ++i)
      if (per_frame[i] != 0)
        own += fmt::format("{}'{}'", own.empty() ? "" : ", ", graph.settings[i].name);
    diagnostics.add(
        DiagnosticId::host_argument, {},
        fmt::format(
            "{}: setting '{}' belongs to the graph; dermis_graph_set_setting sets it for all "
            "views. A view can have its own value of {}",
            function, name, own.empty() ? "none" : own));
    return conclude(log, DERMIS_ERROR_ARGUMENT, std::move(diagnostics), report);
  }
  std::vector<HostSetting> settings = view.settings;
  std::optional<SettingValue> value;
  if (json != nullptr) {
    value = read_setting(*at, json, diagnostics);
    if (!value) return conclude(log, DERMIS_ERROR_CONFIG, std::move(diagnostics), report);
    value = offered_value(*view.graph, graph, *at, *value, diagnostics);
    set_in(settings, name, json);
  } else {
    remove_from(settings, name);
    value = value_of_graph(*view.graph, graph, *at);
  }
  std::vector<choice::Configuration> configurations;
  {
    const std::lock_guard lock(view.mutex);
    configurations = configurations_with(newest(view), view.context->pass_types,
                                         view.chooser.errors, view.chooser.costs, index, *value);
  }
  const dermis_result result = conclude(log, DERMIS_OK, std::move(diagnostics), report);
  if (result != DERMIS_OK) return result;
  const std::lock_guard lock(view.mutex); // nothing fails from here on
  adopt_value(newest(view), index, *value, configurations);
  retire_other_costs(view.chooser, newest(view));
  view.settings.swap(settings);
  return result;
}

} // namespace

void drop_own_settings(const dermis_view_t& view, CompiledGraph& compiled_graph) {
  const std::vector<uint8_t> per_frame =
      frame_settings(compiled_graph.graph, view.context->pass_types);
  for (const HostSetting& own : view.settings) {
    const auto at = find_declared(compiled_graph.graph, own.name);
    const auto index = static_cast<size_t>(at - compiled_graph.graph.settings.begin());
    // A value that a reload did not carry over may name a setting of another kind.
    if (at == compiled_graph.graph.settings.end() || per_frame[index] == 0) continue;
    const SettingValue value = value_of_graph(*view.graph, compiled_graph.graph, *at);
    compiled_graph.settings[index] = value;
    for (choice::Configuration& configuration : compiled_graph.configurations)
      configuration.settings[index] = value;
  }
}

void apply_own_settings(const dermis_view_t& view, CompiledGraph& compiled_graph,
                        Diagnostics& diagnostics) {
  if (view.settings.empty()) return;
  const Graph& graph = compiled_graph.graph;
  const std::vector<uint8_t> per_frame = frame_settings(graph, view.context->pass_types);
  for (const HostSetting& own : view.settings) {
    const auto at = find_declared(graph, own.name);
    const auto index = static_cast<size_t>(at - graph.settings.begin());
    Diagnostics scratch; // the value fitted the previous graph, so it is not an error of this graph
    std::optional<SettingValue> value;
    if (at != graph.settings.end() && per_frame[index] != 0)
      value = read_setting(*at, own.json, scratch);
    if (!value) {
      diagnostics.add(
          DiagnosticId::setting_not_carried,
          at != graph.settings.end() ? at->where : SourceLocation{},
          fmt::format("setting '{}' = {} of a view is not carried over: the new graph has no such "
                      "per-frame setting, or does not accept the value",
                      own.name, own.json));
      continue;
    }
    value = offered_value(*view.graph, graph, *at, *value, scratch);
    compiled_graph.settings[index] = *value;
    for (choice::Configuration& configuration : compiled_graph.configurations)
      configuration.settings[index] = *value;
  }
}

} // namespace dermis::abi

using namespace dermis::abi;

extern "C" dermis_result DERMIS_CALL dermis_graph_set_setting(dermis_graph graph, const char* name,
                                                              const char* json,
                                                              dermis_report* report) {
  if (report != nullptr) *report = nullptr;
  if (graph == nullptr) return bad_argument({}, "dermis_graph_set_setting: graph is NULL");
  const Log& log = graph->context->log;
  return guarded(log, "dermis_graph_set_setting", [&] {
    if (name == nullptr) return bad_argument(log, "dermis_graph_set_setting: name is NULL");
    if (const dermis_result alive = check_alive(*graph->context, "dermis_graph_set_setting");
        alive != DERMIS_OK)
      return alive;
    const std::lock_guard changing(graph->changing);
    return set_setting(*graph, name, json, report);
  });
}

extern "C" dermis_result DERMIS_CALL dermis_view_settings(dermis_view view, uint32_t* count,
                                                          dermis_setting* settings) {
  constexpr const char* function = "dermis_view_settings";
  if (view == nullptr) return bad_argument({}, "{}: view is NULL", function);
  return guarded(view->context->log, function,
                 [&] { return get_settings(*view, function, count, settings); });
}

extern "C" dermis_result DERMIS_CALL dermis_view_set_setting(dermis_view view, const char* name,
                                                             const char* json,
                                                             dermis_report* report) {
  constexpr const char* function = "dermis_view_set_setting";
  if (report != nullptr) *report = nullptr;
  if (view == nullptr) return bad_argument({}, "{}: view is NULL", function);
  const Log& log = view->context->log;
  return guarded(log, function, [&] {
    if (name == nullptr) return bad_argument(log, "{}: name is NULL", function);
    if (const dermis_result alive = check_alive(*view->context, function); alive != DERMIS_OK)
      return alive;
    return set_view_setting(*view, name, json, report);
  });
}
