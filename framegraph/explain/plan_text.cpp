#include "framegraph/explain/plan_text.hpp"

#include "framegraph/explain/names.hpp"
#include "framegraph/explain/reasons.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace dermis {
namespace {

struct TextExporter {
  const Graph& graph;
  const PassTypeRegistry& pass_types;
  const CompiledPlan& compiled;
  const Plan& plan = compiled.plan;
  const ReasonIndex reasons{graph, pass_types, compiled};
  std::string out = {};

  void line(const std::string& text) { out += text + '\n'; }

  std::string reason(Reason::About about, uint32_t index) const {
    return reasons.about(about, index);
  }

  std::string object(uint32_t resource, uint32_t frames_back,
                     const std::string& range_suffix = {}) const {
    const std::string name =
        graph.resources[plan.resources[resource].declared.value].name + range_suffix;
    return frames_back == 0 ? name : fmt::format("{}@-{}", name, frames_back);
  }

  void head() {
    line(fmt::format("plan of graph '{}' for {}x{}, device profile '{}'", plan.graph,
                     plan.view_width, plan.view_height, plan.device_profile));
    line(fmt::format("{} of {} passes run, {} barriers, {} transient, {} history",
                     plan.passes.size(), graph.passes.size(), plan.barriers.size(),
                     bytes_text(plan.transient_bytes), bytes_text(plan.history_bytes)));
    if (!graph.settings.empty()) line("\nsettings");
    for (uint32_t i = 0; i < graph.settings.size(); ++i)
      line("  " + reason(Reason::About::choice, i));
  }

  // Returns the position of the first pass from `position` on that accesses the barrier's resource.
  uint32_t user(const PlanBarrier& barrier, uint32_t position) const {
    for (; position < plan.passes.size(); ++position) {
      const PlanPass& pass = plan.passes[position];
      for (uint32_t a = pass.first_access; a < pass.first_access + pass.access_count; ++a)
        if (plan.accesses[a].resource == barrier.resource &&
            plan.accesses[a].frames_back == barrier.frames_back)
          return position;
    }
    return position;
  }

  const std::string& pass_name(uint32_t position) const {
    return graph.passes[plan.passes[position].declared.value].name;
  }

  // Names the pass after which a queue reaches a point; 0: the last point of its frame.
  std::string wait_text(Queue queue, uint32_t point) const {
    uint32_t found = static_cast<uint32_t>(plan.passes.size());
    for (uint32_t p = 0; p < plan.passes.size(); ++p)
      if (plan.passes[p].queue == queue && plan.passes[p].signal != 0 &&
          (point == 0 || plan.passes[p].signal == point))
        found = p;
    return found == plan.passes.size() ? std::string()
                                       : fmt::format(", after '{}'", pass_name(found));
  }

  // `position` is that of the pass that the barrier precedes.
  void barrier(uint32_t index, uint32_t position) {
    const PlanBarrier& one = plan.barriers[index];
    const std::string from =
        one.from_host ? "host"
                      : stage_text(one.source_stages) + "/" + access_text(one.source_access);
    const std::string to = one.to_host ? "host"
                                       : stage_text(one.destination_stages) + "/" +
                                             access_text(one.destination_access);
    std::string layouts;
    if (plan.resources[one.resource].type == ResourceType::image)
      layouts = fmt::format(", {} -> {}", one.from_host ? "host" : layout_name(one.old_layout),
                            one.to_host ? "host" : layout_name(one.new_layout));
    const uint32_t by = user(one, position);
    const bool early = by != position && by < plan.passes.size() && !one.to_host &&
                       one.transfer != PlanBarrier::Transfer::release;
    line(fmt::format(
        "     | {}{}", reason(Reason::About::barrier, index),
        early ? fmt::format(" (for '{}': merged into this earlier batch)", pass_name(by)) : ""));
    const std::string range_suffix = range_text(plan.resources[one.resource], one.range);
    const std::string half = one.transfer == PlanBarrier::Transfer::none
                                 ? ""
                                 : fmt::format("{}, ", transfer_name(one.transfer));
    line(fmt::format("     |   {}{}{}: {} -> {}{}", half, why_name(one.why),
                     range_suffix.empty() ? "" : " of " + range_suffix, from, to, layouts));
  }

  void waits(Queue for_queue, uint32_t point) {
    line(fmt::format("     | waits for point {} of the {} queue{}{}", point, queue_name(for_queue),
                     wait_text(for_queue, point),
                     point == 0 ? " (the last point of the previous frame)" : ""));
  }

  void passes() {
    line("\npasses, each after its barriers");
    if (const std::string why = reason(Reason::About::order, 0); !why.empty()) line("  " + why);
    for (uint32_t position = 0; position < plan.passes.size(); ++position) {
      const PlanPass& pass = plan.passes[position];
      const PassType& type = pass_types[pass.type];
      if (pass.wait != no_point)
        waits(pass.queue == Queue::main ? Queue::async : Queue::main, pass.wait);
      for (uint32_t b = 0; b < pass.barrier_count; ++b)
        barrier(pass.first_barrier + b, position);
      line(fmt::format("{:4} {} ({}){}", position, graph.passes[pass.declared.value].name,
                       type.name, pass.queue == Queue::main ? "" : " on the async queue"));
      line("       " + reason(Reason::About::pass, pass.declared.value));
      for (uint32_t a = pass.first_access; a < pass.first_access + pass.access_count; ++a) {
        const PlanAccess& access = plan.accesses[a];
        const UsageInfo& usage = usage_info(type.ports[access.port].usage);
        const char* arrow = usage.reads && usage.writes ? "<->" : usage.reads ? "<-" : "->";
        line(fmt::format("       {} {} {}{}", type.ports[access.port].name, arrow,
                         object(access.resource, access.frames_back,
                                range_text(plan.resources[access.resource], access.range)),
                         read_when_text(access.when)));
      }
      for (uint32_t b = 0; b < pass.release_count; ++b)
        barrier(pass.first_barrier + pass.barrier_count + b, position);
      if (pass.signal != 0)
        line(fmt::format("     | the {} queue signals point {}", queue_name(pass.queue),
                         pass.signal));
    }
    if (plan.final_barrier_count > 0) line("   at the end");
    if (plan.final_wait != no_point) waits(Queue::async, plan.final_wait);
    for (uint32_t b = 0; b < plan.final_barrier_count; ++b)
      barrier(plan.first_final_barrier + b, static_cast<uint32_t>(plan.passes.size()));
  }

  void idle_passes() {
    std::vector<bool> runs(graph.passes.size(), false);
    for (const PlanPass& pass : plan.passes)
      runs[pass.declared.value] = true;
    if (std::find(runs.begin(), runs.end(), false) == runs.end()) return;
    line("\npasses that do not run");
    for (uint32_t p = 0; p < graph.passes.size(); ++p)
      if (!runs[p])
        line(fmt::format("  {}: {}", graph.passes[p].name, reason(Reason::About::pass, p)));
  }

  void resources() {
    line("\nresources");
    for (const PlanResource& resource : plan.resources) {
      const std::string size = resource.type == ResourceType::image ? shape_text(resource)
                               : resource.type == ResourceType::buffer
                                   ? fmt::format("{} bytes", resource.bytes)
                                   : "acceleration structure";
      const std::string why = reason(Reason::About::resource, resource.declared.value);
      line(fmt::format("  {}: {}{}{}", graph.resources[resource.declared.value].name, size,
                       why.empty() ? "" : "; ", why));
    }
  }

  void changes(const Provenance& provenance) {
    if (!provenance.changes.empty()) line("\nchanges by other files, in this order");
    for (const Change& change : provenance.changes)
      line(fmt::format("  {:<8} {}  ({})", change_name(change.what), change.at,
                       provenance.place(change)));
  }

  void heap(uint32_t index) {
    const Heap& one = plan.heaps[index];
    line(fmt::format("\nheap {}: {} of {}, at least {} needed{}", index, bytes_text(one.size),
                     one.persistent ? "history" : "transients", bytes_text(one.max_live_bytes),
                     one.size == one.max_live_bytes ? ": optimal" : ""));
    line("        offset         size  passes    what");
    std::vector<uint32_t> inside;
    for (uint32_t i = 0; i < plan.placements.size(); ++i)
      if (plan.placements[i].heap == index) inside.push_back(i);
    std::stable_sort(inside.begin(), inside.end(), [&](uint32_t a, uint32_t b) {
      return plan.placements[a].offset < plan.placements[b].offset;
    });
    for (const uint32_t i : inside) {
      const Placement& placement = plan.placements[i];
      const std::string uses = placement.persistent
                                   ? "all"
                                   : fmt::format("{}..{}", placement.first_use, placement.last_use);
      line(fmt::format("  {:>12} {:>12}  {:<9} {}", placement.offset, placement.size, uses,
                       object(placement.resource, 0)));
    }
  }
};

} // namespace

std::string plan_text(const Graph& graph, const PassTypeRegistry& pass_types,
                      const CompiledPlan& compiled, const Provenance& provenance) {
  TextExporter exporter{graph, pass_types, compiled};
  exporter.head();
  exporter.passes();
  exporter.idle_passes();
  exporter.resources();
  for (uint32_t h = 0; h < compiled.plan.heaps.size(); ++h)
    exporter.heap(h);
  exporter.changes(provenance);
  return std::move(exporter.out);
}

} // namespace dermis
