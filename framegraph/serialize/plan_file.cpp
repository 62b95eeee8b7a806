#include "framegraph/serialize/plan_file.hpp"

#include "framegraph/serialize/plan_fields.hpp"
#include "framegraph/verify/structure.hpp"

#include <fmt/format.h>

namespace dermis {
namespace {

constexpr std::string_view magic = "DERMPLAN";

// Returns the value as a graph file writes it; options by name if they are known.
template <class Options> std::string value_text(const SettingValue& value, const Options& options) {
  switch (value.type) {
  case SettingType::boolean:
    return value.integer != 0 ? "true" : "false";
  case SettingType::integer:
    return fmt::format("{}", value.integer);
  case SettingType::real:
    return fmt::format("{}", value.real);
  case SettingType::enumeration:
  case SettingType::choice:
    break;
  }
  const auto option = static_cast<size_t>(value.integer);
  return value.integer >= 0 && option < options.size() ? fmt::format("\"{}\"", options[option])
                                                       : fmt::format("{}", value.integer);
}

PlanNames names_of(const Graph& graph, const PassTypeRegistry& pass_types, const Plan& plan) {
  PlanNames names;
  for (const PlanResource& resource : plan.resources)
    names.resources.push_back(graph.resources[resource.declared.value].name);
  for (size_t s = 0; s < plan.setting_values.size(); ++s)
    names.settings.push_back(
        {graph.settings[s].name, value_text(plan.setting_values[s], graph.settings[s].options)});
  names.ports.resize(plan.accesses.size());
  names.pass_settings.resize(plan.settings.size());
  for (const PlanPass& pass : plan.passes) {
    const PassType& type = pass_types[pass.type];
    names.passes.push_back(graph.passes[pass.declared.value].name);
    names.pass_types.emplace_back(type.name);
    for (uint32_t a = pass.first_access; a < pass.first_access + pass.access_count; ++a)
      names.ports[a] = type.ports[plan.accesses[a].port].name;
    for (size_t s = 0; s < type.settings.size(); ++s)
      names.pass_settings[pass.first_setting + s] = {
          std::string(type.settings[s].name),
          value_text(plan.settings[pass.first_setting + s].value, type.settings[s].options)};
  }
  return names;
}

// Checks what verify_structure() does not see: key and names, and values that only an executor
// uses.
std::string first_mismatch(const SavedPlan& saved) {
  const Plan& plan = saved.plan;
  const PlanNames& names = saved.names;
  if (names.passes.size() != plan.passes.size() || names.pass_types.size() != plan.passes.size() ||
      names.resources.size() != plan.resources.size() ||
      names.ports.size() != plan.accesses.size() ||
      names.settings.size() != plan.setting_values.size() ||
      names.pass_settings.size() != plan.settings.size())
    return "the numbers of names and of objects in the plan differ";
  if (saved.key.settings.size() != plan.setting_values.size())
    return "key and plan have different numbers of settings";
  if (saved.key.view_width != plan.view_width || saved.key.view_height != plan.view_height ||
      saved.key.pixel_grid != plan.pixel_grid || saved.key.device_profile != plan.device_profile)
    return "key and plan were made for different views or devices";
  uint64_t accesses = 0, barriers = 0, settings = 0;
  for (const PlanPass& pass : plan.passes) {
    if (pass.first_access != accesses || pass.first_barrier != barriers ||
        pass.first_setting < settings)
      return "accesses, barriers and settings are not in the order of their passes";
    if (pass.first_setting > plan.settings.size())
      return "a pass refers to settings that do not exist";
    accesses += pass.access_count;
    barriers += uint64_t{pass.barrier_count} + pass.release_count;
    settings = pass.first_setting;
  }
  if (plan.first_final_barrier != barriers ||
      barriers + plan.final_barrier_count != plan.barriers.size() ||
      accesses != plan.accesses.size())
    return "accesses or barriers belong to no pass";
  for (const PlanSetting& setting : plan.settings)
    if (setting.from.valid() && setting.from.value >= plan.setting_values.size())
      return "a setting of a pass follows one that does not exist";
  return "";
}

} // namespace

SavedPlan saved_plan(const CompileInput& input, const Plan& plan) {
  return {plan_key(input), names_of(*input.graph, *input.pass_types, plan), plan};
}

std::string plan_bytes(const Plan& plan) {
  serial::Writer writer;
  serial::fields(writer, plan);
  return std::move(writer).finish();
}

std::string write_plan(const SavedPlan& saved) {
  serial::Writer writer;
  writer.number("version", plan_file_version);
  serial::fields(writer, saved.key);
  serial::fields(writer, saved.names);
  serial::fields(writer, saved.plan);
  return std::string(magic) + std::move(writer).finish();
}

bool is_plan_file(std::string_view bytes) {
  return bytes.starts_with(magic);
}

std::optional<SavedPlan> read_plan(const std::string& name, std::string_view bytes,
                                   Diagnostics& diagnostics) {
  const SourceLocation where{{static_cast<uint32_t>(diagnostics.files.size())}, 0, 0, ""};
  diagnostics.files.push_back({name, ""});
  const auto reject = [&](const std::string& why) -> std::optional<SavedPlan> {
    diagnostics.add(DiagnosticId::plan_file, where, why);
    return std::nullopt;
  };
  if (!is_plan_file(bytes)) return reject(fmt::format("a saved plan must begin with {}", magic));
  if (bytes.size() > limits::file_bytes)
    return reject(fmt::format("the file has {} bytes; at most {} are accepted", bytes.size(),
                              limits::file_bytes));
  serial::Reader reader(bytes.substr(magic.size()), magic.size());
  uint32_t version = 0;
  reader.number("version", version);
  if (reader.problem().empty() && version != plan_file_version)
    return reject(fmt::format("the plan has version {}; this library reads version {}", version,
                              plan_file_version));
  SavedPlan saved;
  serial::fields(reader, saved.key);
  serial::fields(reader, saved.names);
  serial::fields(reader, saved.plan);
  reader.expect_end();
  if (!reader.problem().empty()) return reject(reader.problem());
  if (const std::string mismatch = first_mismatch(saved); !mismatch.empty())
    return reject(mismatch);
  if (const std::vector<std::string> violations = verify_structure(saved.plan); !violations.empty())
    return reject(violations.front());
  return saved;
}

} // namespace dermis
