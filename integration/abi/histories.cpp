// Describes the state of a view's histories.

#include "integration/abi/graph.hpp"
#include "integration/abi/settling.hpp"
#include "integration/abi/two_call.hpp"

#include <algorithm>
#include <string_view>
#include <vector>

namespace dermis::abi {
namespace {

dermis_history_reason reason_of(vulkan::HistoryReason reason) {
  switch (reason) {
  case vulkan::HistoryReason::cut:
    return DERMIS_HISTORY_CUT;
  case vulkan::HistoryReason::resized:
    return DERMIS_HISTORY_RESIZED;
  case vulkan::HistoryReason::reloaded:
    return DERMIS_HISTORY_RELOADED;
  case vulkan::HistoryReason::switched:
    return DERMIS_HISTORY_OTHER_PLAN;
  case vulkan::HistoryReason::left_out:
    return DERMIS_HISTORY_LEFT_OUT;
  case vulkan::HistoryReason::valid: // not a reason
  case vulkan::HistoryReason::first_frame:
    break;
  }
  return DERMIS_HISTORY_NEVER_WRITTEN;
}

struct KnownHistory {
  vulkan::HistoryState state;
  uint32_t settles_after = 1; // frames
};

// Adds the histories of a plan that are not yet in `all`, as its next frame will find them.
void add_histories(const PassTypeRegistry& pass_types, const CompiledGraph& compiled_graph,
                   const RunnablePlan& plan, const vulkan::Executor* before,
                   std::vector<KnownHistory>& all) {
  for (uint32_t i = 0; i < plan.executor->history_count(); ++i) {
    vulkan::HistoryState state = plan.executor->history_state(i, false, before);
    const auto same = [&](const KnownHistory& one) { return one.state.resource == state.resource; };
    if (std::any_of(all.begin(), all.end(), same)) continue;
    const vulkan::HistoryState own = plan.executor->history_state(i);
    if (!state.valid && !plan.recorded && own.lost == vulkan::HistoryReason::first_frame)
      state.lost = own.lost; // the plan never ran, so no other plan ran in between
    all.push_back(
        {state,
         settling_frames(pass_types, plan.compiled->plan, i,
                         compiled_graph.configurations[compiled_graph.configuration].settings)});
  }
}

// Lists the plan that ran last, or will run first, before the others.
std::vector<KnownHistory> histories_of(const dermis_view_t& view,
                                       const CompiledGraph& compiled_graph) {
  const PassTypeRegistry& pass_types = view.context->pass_types;
  std::vector<KnownHistory> all;
  const uint32_t last = compiled_graph.plan;
  const vulkan::Executor* const before = recorded_before(view, compiled_graph, last);
  add_histories(pass_types, compiled_graph, compiled_graph.plans[last], before, all);
  for (uint32_t v = 0; v < compiled_graph.plans.size(); ++v)
    if (v != last)
      add_histories(pass_types, compiled_graph, compiled_graph.plans[v],
                    recorded_before(view, compiled_graph, v), all);
  return all;
}

} // namespace

dermis_result get_histories(const dermis_view_t& view, const char* function, uint32_t* count,
                            dermis_history* out) {
  const std::lock_guard lock(view.mutex);
  const auto all = histories_of(view, view.next ? *view.next : *view.running);
  return fill_array(view.context->log, function, count, out, static_cast<uint32_t>(all.size()),
                    [&](uint32_t i) {
                      dermis_history history = DERMIS_HISTORY_INIT;
                      const vulkan::HistoryState& state = all[i].state;
                      history.name = state.resource.data(); // of a std::string of the executor
                      history.valid = state.valid ? 1 : 0;
                      history.age = state.age;
                      history.reason = reason_of(state.lost);
                      history.settles_after = all[i].settles_after;
                      history.text = state.valid ? vulkan::valid_since_text(state.lost)
                                                 : vulkan::history_reason_text(state.lost);
                      return history;
                    });
}

} // namespace dermis::abi
