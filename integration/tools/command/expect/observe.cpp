#include "integration/tools/command/expect/observe.hpp"

#include "framegraph/explain/reasons.hpp"
#include "framegraph/verify/verify.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace dermis::tools {
namespace {

DeviceProfile device_of(const ExpectedCase& inputs) {
  DeviceProfile device = generic_profile();
  device.features &= ~inputs.unmet;
  if (inputs.max_image_dimension) device.max_image_dimension = *inputs.max_image_dimension;
  device.supports = [all = device.supports,
                     without = inputs.unsupported_formats](Format format, uint32_t vk_usage) {
    return std::find(without.begin(), without.end(), format) == without.end() &&
           all(format, vk_usage);
  };
  return device;
}

// Returns one format per resource of the graph. Sets `problem` to an unknown resource.
std::vector<Format> host_formats(const Graph& graph, const ExpectedCase& inputs,
                                 std::string& problem) {
  std::vector<Format> out(graph.resources.size(), Format::undefined);
  for (const auto& binding : inputs.host_formats) {
    const std::string& name = binding.first;
    const auto found =
        std::find_if(graph.resources.begin(), graph.resources.end(),
                     [&](const ResourceDeclaration& one) { return one.name == name; });
    if (found == graph.resources.end())
      problem = fmt::format("'host_formats': the graph has no resource '{}'", name);
    else
      out[static_cast<size_t>(found - graph.resources.begin())] = binding.second;
  }
  return out;
}

MachineInfo facts_of(const Graph& graph, const PassTypeRegistry& pass_types,
                     const CompiledPlan& compiled) {
  const Plan& plan = compiled.plan;
  MachineInfo info;
  info.passes.emplace();
  info.culled.emplace();
  std::vector<bool> runs(graph.passes.size(), false);
  uint64_t batches = plan.final_barrier_count > 0 ? 1 : 0;
  for (const PlanPass& pass : plan.passes) {
    runs[pass.declared.value] = true;
    info.passes->push_back(graph.passes[pass.declared.value].name);
    batches += pass.barrier_count > 0 ? 1 : 0;
  }
  for (size_t p = 0; p < graph.passes.size(); ++p)
    if (!runs[p]) info.culled->emplace(graph.passes[p].name, "");
  for (const Reason& reason : compiled.reasons) {
    if (reason.about != Reason::About::pass || runs[reason.index]) continue;
    std::string& why = (*info.culled)[graph.passes[reason.index].name];
    why += (why.empty() ? "" : "; ") + reason_text(graph, pass_types, plan, reason);
  }
  info.barriers = plan.barriers.size();
  info.batches = batches;
  info.transient_bytes = plan.transient_bytes;
  info.history_bytes = plan.history_bytes;
  return info;
}

} // namespace

Observation observe_messages(const Diagnostics& diagnostics) {
  Observation out;
  for (const Diagnostic& one : diagnostics.list) {
    out.info.diagnostics.emplace_back(diagnostic_info(one.id).code);
    out.messages.push_back(format_for_people(diagnostics, one));
  }
  return out;
}

Observation observe(const LoadedGraph& loaded, const ExpectedCase& inputs) {
  Observation out;
  const CompileChoices choices = read_choices(loaded.graph, inputs.settings, inputs.unbound);
  out.problem = choices.problem;
  const DeviceProfile device = device_of(inputs);
  CompileInput input;
  input.graph = &loaded.graph;
  input.pass_types = &loaded.pass_types;
  input.device = &device;
  input.view_width = inputs.size.width;
  input.view_height = inputs.size.height;
  input.settings = choices.settings;
  input.bound = choices.bound;
  input.host_formats = host_formats(loaded.graph, inputs, out.problem);
  if (!out.problem.empty()) return out;
  Diagnostics diagnostics;
  const std::optional<CompiledPlan> compiled = compile(input, diagnostics);
  out = observe_messages(diagnostics);
  if (!compiled) return out;
  const std::vector<std::string> codes = std::move(out.info.diagnostics);
  out.info = facts_of(loaded.graph, loaded.pass_types, *compiled);
  out.info.diagnostics = codes;
  Verdict verdict = verify(compiled->plan);
  out.violations = std::move(verdict.violations);
  out.not_verified = std::move(verdict.not_verified);
  return out;
}

} // namespace dermis::tools
