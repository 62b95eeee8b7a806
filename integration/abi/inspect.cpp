// Describes a graph to the host: slots, plan, memory and times.

#include "framegraph/explain/plan_dot.hpp"
#include "framegraph/explain/plan_json.hpp"
#include "framegraph/explain/plan_text.hpp"
#include "integration/abi/graph.hpp"
#include "integration/abi/two_call.hpp"

#include <algorithm>
#include <map>

namespace dermis::abi {
namespace {

dermis_slot describe_slot(const Slot& slot, uint32_t id) {
  dermis_slot out = DERMIS_SLOT_INIT;
  out.id = id;
  out.required = slot.required ? 1 : 0;
  out.name = slot.name.c_str();
  out.written = slot.written ? 1 : 0;
  out.read = slot.read ? 1 : 0;
  out.format = static_cast<VkFormat>(format_info(slot.format).vulkan);
  out.usage = slot.vk_usage;
  out.best_layout = static_cast<VkImageLayout>(slot.first_layout);
  out.width = slot.width;
  out.height = slot.height;
  out.bound = slot.in_plan ? 1 : 0;
  out.type = static_cast<dermis_slot_type>(slot.type);
  out.stride = slot.stride;
  out.bytes = slot.bytes;
  return out;
}

// Returns the size of the transients without aliasing, by memory type mask. Sizes are rounded up to
// the largest alignment of the heap, so the result is never below the packed size, for which each
// placement only has its own alignment.
using BytesByTypes = std::map<uint32_t, uint64_t>;
BytesByTypes unaliased_bytes(const Plan& plan) {
  BytesByTypes sums;
  for (const Placement& placement : plan.placements) {
    if (placement.persistent) continue;
    const Heap& heap = plan.heaps[placement.heap];
    sums[heap.memory_type_bits] +=
        (placement.size + heap.alignment - 1) / heap.alignment * heap.alignment;
  }
  return sums;
}

dermis_memory memory_of(const CompiledGraph& compiled_graph) {
  dermis_memory out = DERMIS_MEMORY_INIT;
  BytesByTypes maximum; // over the plans, because only one runs per frame
  for (const RunnablePlan& runnable : compiled_graph.plans) {
    const Plan& plan = runnable.compiled->plan;
    for (const auto& [types, bytes] : unaliased_bytes(plan))
      maximum[types] = std::max(maximum[types], bytes);
    out.transient_bytes = std::max(out.transient_bytes, plan.transient_bytes);
    out.history_bytes += plan.history_bytes;
    out.constant_bytes += runnable.executor->constant_bytes();
  }
  for (const auto& [types, bytes] : maximum)
    out.transient_unaliased_bytes += bytes;
  out.constant_bytes += compiled_graph.tables->bytes();
  if (compiled_graph.heap_pool) {
    out.transient_bytes = compiled_graph.heap_pool->transient_bytes();
    out.history_bytes = compiled_graph.heap_pool->history_bytes();
  }
  return out;
}

// Adds up the device memory of all views, and the tables that they share.
dermis_memory total_memory(dermis_graph_t& graph) {
  dermis_memory sum = DERMIS_MEMORY_INIT;
  for_each_view(graph, [&](const dermis_view_t& view) {
    const dermis_memory one = memory_of(*keep_newest(view));
    sum.transient_bytes += one.transient_bytes;
    sum.transient_unaliased_bytes += one.transient_unaliased_bytes;
    sum.history_bytes += one.history_bytes;
    sum.constant_bytes += one.constant_bytes;
  });
  sum.constant_bytes += graph.input.device_tables->bytes();
  return sum;
}

// Returns the heaps of one view in a stable order: shared ones, then plan by plan.
std::vector<vulkan::MemoryRequest> heaps_of(const CompiledGraph& compiled_graph) {
  std::vector<vulkan::MemoryRequest> heaps;
  if (compiled_graph.heap_pool)
    for (const vulkan::HeapPool::Block& block : compiled_graph.heap_pool->blocks())
      heaps.push_back(block.request);
  for (const RunnablePlan& plan : compiled_graph.plans)
    for (uint32_t h = 0; h < plan.compiled->plan.heaps.size(); ++h)
      if (const vulkan::MemoryRequest request = plan.executor->heap_request(h); request.bytes > 0)
        heaps.push_back(request);
  return heaps;
}

struct TimedPlan {
  const RunnablePlan* plan = nullptr;
  uint64_t frame_index = 0;
  std::vector<vulkan::PassTiming> times; // by pass
};

// Finds the plan that ran the newest frame up to `completed` whose times can be read.
TimedPlan find_timed_plan(const CompiledGraph& compiled_graph, uint64_t completed) {
  TimedPlan newest;
  for (const RunnablePlan& plan : compiled_graph.plans) {
    TimedPlan found{&plan, 0, {}};
    found.times.resize(plan.compiled->plan.passes.size());
    if (plan.executor->read_timings(completed, found.frame_index, found.times) &&
        found.frame_index > newest.frame_index)
      newest = std::move(found);
  }
  return newest;
}

} // namespace

dermis_result get_timings(dermis_view_t& view, const char* function, uint64_t completed,
                          uint32_t* count, dermis_pass_timing* out) {
  const Log& log = view.context->log;
  if (count == nullptr) return bad_argument(log, "{}: count is NULL", function);
  const std::lock_guard lock(view.mutex);
  if (const dermis_result loss = check_loss(view, function); loss != DERMIS_OK) return loss;
  CompiledGraph& compiled_graph = view.running ? *view.running : newest(view);
  const TimedPlan timed = find_timed_plan(compiled_graph, std::min(completed, view.last_frame));
  const RunnablePlan& plan = timed.plan != nullptr ? *timed.plan : compiled_graph.recorded();
  const std::vector<PlanPass>& passes = plan.compiled->plan.passes;
  if (out == nullptr) {
    *count = static_cast<uint32_t>(passes.size());
    return DERMIS_OK;
  }
  if (timed.plan == nullptr) {
    const dermis_result loss = check_loss(view, function);
    return loss != DERMIS_OK ? loss : DERMIS_NOT_READY;
  }
  return fill_array(log, function, count, out, static_cast<uint32_t>(passes.size()),
                    [&](uint32_t i) {
                      dermis_pass_timing timing = DERMIS_PASS_TIMING_INIT;
                      const PassId declared = passes[i].declared;
                      timing.pass = compiled_graph.graph.passes[declared.value].name.c_str();
                      timing.frame_index = timed.frame_index;
                      timing.nanoseconds = timed.times[i].nanoseconds;
                      return timing;
                    });
}

} // namespace dermis::abi

using namespace dermis::abi;

extern "C" dermis_result DERMIS_CALL dermis_graph_slots(dermis_graph graph, uint32_t* count,
                                                        dermis_slot* slots) {
  if (graph == nullptr) return bad_argument({}, "dermis_graph_slots: graph is NULL");
  const Log& log = graph->context->log;
  return guarded(log, "dermis_graph_slots", [&] {
    const std::shared_ptr<CompiledGraph> compiled_graph = keep_newest(graph->own);
    const auto& all = compiled_graph->slots;
    return fill_array(log, "dermis_graph_slots", count, slots, static_cast<uint32_t>(all.size()),
                      [&](uint32_t i) { return describe_slot(all[i], i); });
  });
}

extern "C" dermis_result DERMIS_CALL dermis_graph_describe(dermis_graph graph,
                                                           dermis_describe_format format,
                                                           size_t* size, char* text) {
  if (graph == nullptr) return bad_argument({}, "dermis_graph_describe: graph is NULL");
  const Log& log = graph->context->log;
  return guarded(log, "dermis_graph_describe", [&] {
    if (size == nullptr) return bad_argument(log, "dermis_graph_describe: size is NULL");
    const std::lock_guard changing(graph->changing);
    std::shared_ptr<const CompiledGraph> kept;
    std::shared_ptr<const dermis::CompiledPlan> plan;
    {
      const std::lock_guard lock(
          graph->own.mutex); // the newest configuration changes with each frame
      kept = graph->own.next ? graph->own.next : graph->own.running;
      plan = kept->current().compiled;
    }
    const CompiledGraph& compiled_graph = *kept;
    const dermis::PassTypeRegistry& pass_types = graph->context->pass_types;
    const dermis::CompiledPlan& compiled = *plan;
    std::string description;
    switch (static_cast<int>(format)) {
    case DERMIS_DESCRIBE_JSON:
      description = dermis::plan_json(compiled_graph.graph, pass_types, compiled,
                                      {compiled_graph.changes, compiled_graph.files});
      break;
    case DERMIS_DESCRIBE_DOT:
      description = dermis::plan_dot(compiled_graph.graph, pass_types, compiled);
      break;
    case DERMIS_DESCRIBE_TEXT:
      description = dermis::plan_text(compiled_graph.graph, pass_types, compiled,
                                      {compiled_graph.changes, compiled_graph.files});
      break;
    default:
      return bad_argument(log, "dermis_graph_describe: format is {}, expected 0..2",
                          static_cast<int>(format));
    }
    return fill_text(description, size, text);
  });
}

extern "C" dermis_result DERMIS_CALL dermis_graph_memory(dermis_graph graph,
                                                         dermis_memory* memory) {
  if (graph == nullptr) return bad_argument({}, "dermis_graph_memory: graph is NULL");
  const Log& log = graph->context->log;
  return guarded(log, "dermis_graph_memory", [&] {
    if (memory == nullptr) return bad_argument(log, "dermis_graph_memory: memory is NULL");
    const size_t size = stated_size(memory);
    if (const SizedRead read = check_size<dermis_memory>(size); read != SizedRead::ok)
      return rejected_size(log, read, "dermis_graph_memory: memory", size, sizeof(dermis_memory));
    const std::lock_guard changing(graph->changing);
    write_sized(memory, size, total_memory(*graph));
    return DERMIS_OK;
  });
}

extern "C" dermis_result DERMIS_CALL dermis_graph_heaps(dermis_graph graph, uint32_t* count,
                                                        dermis_memory_request* heaps) {
  constexpr const char* function = "dermis_graph_heaps";
  if (graph == nullptr) return bad_argument({}, "{}: graph is NULL", function);
  const Log& log = graph->context->log;
  return guarded(log, function, [&] {
    const auto all = heaps_of(*keep_newest(graph->own));
    return fill_array(log, function, count, heaps, static_cast<uint32_t>(all.size()),
                      [&](uint32_t i) { return request_of(all[i]); });
  });
}
