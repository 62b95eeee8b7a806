// Values of the settings, and which passes their `when` turns on.

#include "framegraph/compile/availability.hpp"
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
    return std::isfinite(value.real) && value.real >= declared.minimum && value.real <= declared.maximum;
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

void check_features(CompileContext& c) {
  const Features missing = c.graph->features & ~c.device->features;
  if (missing == 0) return;
  c.diagnostics->add(DiagnosticId::device_feature, c.graph->requires_where,
                     fmt::format("graph '{}' cannot run on '{}': {}", c.graph->name, c.device->name,
                                 missing_text(*c.graph, {missing, {}})));
}

// The value that counts, where `value` names an option that is not offered.
SettingValue settled(CompileContext& c, uint32_t setting, const SettingValue& value) {
  const SettingDeclaration& declared = c.graph->settings[setting];
  if (declared.needs.empty()) return value;
  const MissingRequirements unmet =
      missing_requirements(declared, value.integer, c.device->features, c.input->bound);
  if (!unmet.any()) return value;
  c.record_reason(Reason::About::choice, setting, Reason::ReasonKind::not_available,
                  static_cast<uint32_t>(value.integer), unmet.features,
                  unmet.imports.empty() ? 0 : unmet.imports.front().value);
  return available_option(declared, value, c.device->features, c.input->bound);
}

} // namespace

void choose(CompileContext& c) {
  c.settings.clear();
  c.on.clear();
  c.kind_of.clear();
  c.ordered = false;
  check_features(c);
  for (uint32_t i = 0; i < c.graph->settings.size(); ++i) {
    const SettingDeclaration& declared = c.graph->settings[i];
    const bool given = !c.input->settings.empty();
    const SettingValue value = given ? c.input->settings[i] : declared.default_value;
    if (!acceptable(declared, value))
      c.diagnostics->add(
          DiagnosticId::setting_value, declared.where,
          fmt::format("setting '{}' cannot be {}", declared.name, setting_text(declared, value)));
    const SettingValue used = settled(c, i, value);
    c.settings.push_back(used);
    if (used.integer != value.integer) continue; // said already
    const bool differs =
        value.integer != declared.default_value.integer || value.real != declared.default_value.real;
    c.record_reason(Reason::About::choice, i,
                    differs ? Reason::ReasonKind::requested : Reason::ReasonKind::by_default);
  }
  c.out->plan.setting_values = c.settings;
  constexpr size_t ahead = 8;
  for (uint32_t i = 0; i < c.graph->passes.size(); ++i) {
    if (i + ahead < c.graph->passes.size()) {
      fetch(&c.graph->passes[i + ahead].when);
      fetch(&c.graph->passes[i + ahead].after);
    }
    const ExpressionId when = c.graph->passes[i].when;
    c.kind_of.push_back(c.graph->passes[i].type);
    c.ordered |= !c.graph->passes[i].after.empty();
    c.on.push_back(!when.valid() || evaluate(*c.graph, when, c.settings));
    if (!c.on.back()) c.record_reason(Reason::About::pass, i, Reason::ReasonKind::off);
  }
}

} // namespace dermis
