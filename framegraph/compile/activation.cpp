// Resolves the values of settings and evaluates each pass's `when`.

#include "framegraph/compile/availability.hpp"
#include "framegraph/compile/hardware.hpp"
#include "framegraph/compile/phases.hpp"
#include "framegraph/model/expression.hpp"

#include <fmt/format.h>

#include <cmath>

namespace dermis {
namespace {

bool has_options(SettingType type) {
  return type == SettingType::enumeration || type == SettingType::choice;
}

bool acceptable(const SettingDeclaration& declared, const SettingValue& value) {
  if (value.type != declared.type) return false;
  switch (declared.type) {
  case SettingType::boolean:
    return value.integer == 0 || value.integer == 1;
  case SettingType::integer: {
    const auto as_real = static_cast<double>(value.integer); // ranges in files are well inside 2^53
    return as_real >= declared.minimum && as_real <= declared.maximum;
  }
  case SettingType::real:
    return std::isfinite(value.real) && value.real >= declared.minimum &&
           value.real <= declared.maximum;
  case SettingType::enumeration:
  case SettingType::choice:
    return value.integer >= 0 && static_cast<uint64_t>(value.integer) < declared.options.size();
  }
  return false;
}

} // namespace

std::string setting_text(const SettingDeclaration& setting, const SettingValue& value) {
  if (value.type == SettingType::boolean) return value.integer != 0 ? "true" : "false";
  if (value.type == SettingType::real) return fmt::format("{}", value.real);
  if (has_options(value.type) && value.integer >= 0 &&
      static_cast<size_t>(value.integer) < setting.options.size())
    return fmt::format("'{}'", setting.options[static_cast<size_t>(value.integer)]);
  return fmt::format("{}", value.integer);
}

namespace {

void check_features(const CompileInput& in, Report& report) {
  const Graph& graph = *in.graph;
  const Features missing = graph.features & ~in.device->features;
  if (missing == 0) return;
  report.diagnostics.add(DiagnosticId::device_feature, graph.requires_where,
                         fmt::format("graph '{}' cannot run on '{}': {}", graph.name,
                                     in.device->name, missing_text(graph, {missing, {}})));
}

// Returns `value`, or another option if the device or the bound slots do not allow the option in
// `value`.
SettingValue available_value(const CompileInput& in, uint32_t setting, const SettingValue& value,
                             Report& report) {
  const SettingDeclaration& declared = in.graph->settings[setting];
  if (declared.needs.empty()) return value;
  const MissingRequirements unmet =
      missing_requirements(declared, value.integer, in.device->features, in.bound);
  if (!unmet.any()) return value;
  report.record_reason(Reason::About::choice, setting, Reason::ReasonKind::not_available,
                       static_cast<uint32_t>(value.integer), unmet.features,
                       unmet.imports.empty() ? 0 : unmet.imports.front().value);
  return available_option(declared, value, in.device->features, in.bound);
}

void resolve_setting(const CompileInput& in, uint32_t setting, Activation& active, Report& report) {
  const SettingDeclaration& declared = in.graph->settings[setting];
  const SettingValue value = in.settings.empty() ? declared.default_value : in.settings[setting];
  if (!acceptable(declared, value))
    report.diagnostics.add(
        DiagnosticId::setting_value, declared.where,
        fmt::format("setting '{}' cannot be {}", declared.name, setting_text(declared, value)));
  const SettingValue used = available_value(in, setting, value, report);
  active.settings.push_back(used);
  if (used.integer != value.integer) return; // the reason is recorded already
  const bool differs =
      value.integer != declared.default_value.integer || value.real != declared.default_value.real;
  report.record_reason(Reason::About::choice, setting,
                       differs ? Reason::ReasonKind::requested : Reason::ReasonKind::by_default);
}

} // namespace

const Activation& evaluate_conditions(const CompileInput& in, Report& report,
                                      ActivationScratch& scratch) {
  const Graph& graph = *in.graph;
  Activation& active = scratch.result;
  active.pass_types = in.pass_types;
  active.settings.clear();
  active.on.clear();
  active.type_of.clear();
  active.ordered = false;
  check_features(in, report);
  for (uint32_t i = 0; i < graph.settings.size(); ++i)
    resolve_setting(in, i, active, report);
  constexpr size_t ahead = 8;
  for (uint32_t i = 0; i < graph.passes.size(); ++i) {
    if (i + ahead < graph.passes.size()) {
      prefetch(&graph.passes[i + ahead].when);
      prefetch(&graph.passes[i + ahead].after);
    }
    const PassDeclaration& pass = graph.passes[i];
    active.type_of.push_back(pass.type);
    active.ordered |= !pass.after.empty();
    active.on.push_back(!pass.when.valid() || evaluate(graph, pass.when, active.settings));
    if (!active.on.back()) report.record_reason(Reason::About::pass, i, Reason::ReasonKind::off);
  }
  return active;
}

SettingValue setting_value(const Graph& graph, const Activation& active, PassId pass,
                           uint32_t setting) {
  for (const SettingBinding& binding : graph.passes[pass.value].settings)
    if (binding.setting == setting)
      return binding.from.valid() ? active.settings[binding.from.value] : binding.literal;
  return active.type(pass).settings[setting].default_value;
}

} // namespace dermis
