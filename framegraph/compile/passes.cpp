// Lists the scheduled passes in the plan with their settings, and checks the device's limits.

#include "framegraph/compile/availability.hpp"
#include "framegraph/compile/phases.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace dermis {
namespace {

void add_settings(const Graph& graph, const Activation& active, PassId pass, PlanPass& planned,
                  Plan& plan) {
  const PassDeclaration& declared = graph.passes[pass.value];
  const PassType& type = active.type(pass);
  planned.first_setting = static_cast<uint32_t>(plan.settings.size());
  for (uint32_t s = 0; s < type.settings.size(); ++s) {
    PlanSetting setting;
    setting.value = setting_value(graph, active, pass, s);
    for (const SettingBinding& binding : declared.settings)
      if (binding.setting == s) setting.from = binding.from;
    plan.settings.push_back(setting);
  }
}

// Returns whether the pass keeps all limits of the device; reports each limit that it exceeds.
bool check_limits(const CompileInput& in, const PassType& type, PassId pass, Report& report) {
  const Graph& graph = *in.graph;
  bool fits = (type.features & ~in.device->features) == 0;
  const auto report_limit = [&](const std::string& text) {
    fits = false;
    report.diagnostics.add(
        DiagnosticId::device_limit, graph.passes[pass.value].where,
        fmt::format("pass '{}' {} (device '{}')", name_of(graph, pass), text, in.device->name));
  };
  if (const Features missing = type.features & ~in.device->features; missing != 0)
    report.diagnostics.add(DiagnosticId::device_feature, graph.passes[pass.value].where,
                           fmt::format("pass '{}' cannot run on '{}': {}", name_of(graph, pass),
                                       in.device->name, missing_text(graph, {missing, {}})));
  const uint32_t push_bytes = push_constant_bytes(type);
  if (push_bytes > in.device->max_push_constants_bytes)
    report_limit(fmt::format("needs {} bytes of push constants; the limit is {}", push_bytes,
                             in.device->max_push_constants_bytes));
  const GroupCount count = group_count(type.dispatch, in.view_width, in.view_height);
  const uint64_t groups = std::max(count.x, count.y);
  if (groups > in.device->max_workgroup_count)
    report_limit(fmt::format("dispatches {} groups in one dimension; the limit is {}", groups,
                             in.device->max_workgroup_count));
  return fits;
}

} // namespace

void plan_passes(const CompileInput& in, const Activation& active, const QueueAssignment& queues,
                 const Schedule& schedule, Report& report, Plan& plan, PassScratch& scratch) {
  using Fit = PassScratch::Fit;
  scratch.fits.assign(in.pass_types->size(), Fit::unknown);
  for (const PassId pass : schedule.order) {
    PlanPass& planned = plan.passes.emplace_back();
    planned.declared = pass;
    planned.type = active.type_of[pass.value];
    if (queues.two()) planned.queue = queues.by_pass[pass.value];
    add_settings(*in.graph, active, pass, planned, plan);
    Fit& fit =
        scratch.fits[planned.type.value]; // every pass of a type that does not fit is reported
    if (fit != Fit::yes)
      fit = check_limits(in, active.type(pass), pass, report) ? Fit::yes : Fit::no;
  }
}

} // namespace dermis
