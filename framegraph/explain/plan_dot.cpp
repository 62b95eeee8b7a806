#include "framegraph/explain/plan_dot.hpp"

#include "framegraph/explain/names.hpp"
#include "framegraph/explain/reasons.hpp"
#include "framegraph/model/image_range.hpp"

#include <fmt/format.h>

namespace dermis {
namespace {

std::string quoted(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    if (c == '\n')
      result += "\\n";
    else
      result += c;
  }
  return result + "\"";
}

std::string header(const std::string& name) {
  return fmt::format(
      "digraph {} {{\n  rankdir=LR;\n  node [fontname=\"sans-serif\", fontsize=11];\n",
      quoted(name));
}

std::string pass_node(const Graph& graph, const PassTypeRegistry& pass_types, uint32_t pass,
                      const std::string& prefix, const std::string& style) {
  const PassDeclaration& declared = graph.passes[pass];
  const std::string label =
      fmt::format("{}{}\n{}", prefix, declared.name, pass_types[declared.type].name);
  return fmt::format("  p{} [shape=box, label={}{}];\n", pass, quoted(label), style);
}

std::string resource_node(const ResourceDeclaration& declared, uint32_t index,
                          const std::string& detail) {
  const bool slot = declared.origin == Origin::imported || declared.exported;
  return fmt::format("  r{} [shape=ellipse, peripheries={}, label={}];\n", index, slot ? 2 : 1,
                     quoted(declared.name + detail));
}

// A port that both reads and writes gets an arrow each way.
std::string arrows(uint32_t pass, uint32_t resource, uint32_t frames_back,
                   const std::string& range_suffix, const Port& port) {
  const UsageInfo& usage = usage_info(port.usage);
  const std::string name =
      range_suffix.empty() ? std::string(port.name) : fmt::format("{} {}", port.name, range_suffix);
  const std::string label =
      quoted(frames_back > 0 ? fmt::format("{} @-{}", name, frames_back) : name) +
      (frames_back > 0 ? ", style=dashed" : "");
  std::string result;
  if (usage.reads) result += fmt::format("  r{} -> p{} [label={}];\n", resource, pass, label);
  if (usage.writes) result += fmt::format("  p{} -> r{} [label={}];\n", pass, resource, label);
  return result;
}

} // namespace

std::string plan_dot(const Graph& graph, const PassTypeRegistry& pass_types,
                     const CompiledPlan& compiled) {
  const Plan& plan = compiled.plan;
  std::string out = header(plan.graph);
  for (const PlanResource& resource : plan.resources) {
    const bool image = resource.type == ResourceType::image;
    const std::string detail = image ? fmt::format("\n{} {}x{}", format_info(resource.format).name,
                                                   resource.width, resource.height)
                               : resource.type == ResourceType::buffer
                                   ? fmt::format("\n{} bytes", resource.bytes)
                                   : "\nacceleration structure";
    out += resource_node(graph.resources[resource.declared.value], resource.declared.value, detail);
  }
  std::vector<bool> runs(graph.passes.size(), false);
  const ReasonIndex reasons(graph, pass_types, compiled);
  for (uint32_t position = 0; position < plan.passes.size(); ++position) {
    const PlanPass& pass = plan.passes[position];
    runs[pass.declared.value] = true;
    out += pass_node(graph, pass_types, pass.declared.value, fmt::format("{}. ", position), "");
    for (uint32_t a = pass.first_access; a < pass.first_access + pass.access_count; ++a) {
      const PlanAccess& access = plan.accesses[a];
      out += arrows(pass.declared.value, plan.resources[access.resource].declared.value,
                    access.frames_back, range_text(plan.resources[access.resource], access.range),
                    pass_types[pass.type].ports[access.port]);
    }
  }
  for (uint32_t p = 0; p < graph.passes.size(); ++p) {
    if (runs[p]) continue;
    const std::string why = reasons.about(Reason::About::pass, p);
    out += pass_node(graph, pass_types, p, "",
                     fmt::format(", color=gray, fontcolor=gray, tooltip={}", quoted(why)));
  }
  return out + "}\n";
}

} // namespace dermis
