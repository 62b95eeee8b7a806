// What the executor knows about its histories.
#include "framegraph/vulkan/executor/state.hpp"

namespace dermis::vulkan {

const char* history_reason_text(HistoryReason reason) {
  switch (reason) {
  case HistoryReason::valid:
    return "valid";
  case HistoryReason::first_frame:
    return "nothing has been recorded yet";
  case HistoryReason::cut:
    return "camera cut";
  case HistoryReason::resized:
    return "the view was resized";
  case HistoryReason::reloaded:
    return "the graph was reloaded";
  case HistoryReason::discarded:
    return "a recorded frame was discarded";
  case HistoryReason::switched:
    return "frames ran with another plan";
  case HistoryReason::left_out:
    return "a frame ran without the passes that write it";
  }
  return "unknown";
}

uint32_t access_now(const State& state, const PortAccess& port) noexcept {
  if (port.history == no_index) return port.access;
  const bool valid = state.histories[port.history].age >= state.plan.accesses[port.access].frames_back;
  return valid ? port.access : port.otherwise;
}

void forget_histories(State& state, HistoryReason reason) noexcept {
  for (size_t h = 0; h < state.histories.size(); ++h) {
    state.histories[h].age = 0;
    state.histories[h].reason = reason;
    const PlanResource& resource = state.plan.resources[state.plan.histories[h].resource];
    for (uint32_t i = 0; resource.first_instance != no_instance && i < resource.instance_count; ++i)
      state.instances[resource.first_instance + i].ready = false;
  }
}

uint32_t Executor::history_count() const noexcept {
  return static_cast<uint32_t>(state_->histories.size());
}

HistoryState Executor::history_state(uint32_t index, bool reset_history,
                                     const Executor* before) const noexcept {
  if (index >= state_->histories.size()) return {};
  const HistoryRecord& record = state_->histories[index];
  if (before != nullptr) {
    const CarriedHistory carried = carried_history(*state_, index, *before->state_, reset_history);
    const bool replaced = record.reason == HistoryReason::reloaded || record.reason == HistoryReason::resized;
    const HistoryReason lost = replaced && record.age == 0 ? record.reason : HistoryReason::switched;
    return {record.name, carried.age > 0, carried.age, carried.age > 0 ? HistoryReason::valid : lost};
  }
  const HistoryDeclaration& declaration = state_->plan.histories[index].declaration;
  if (reset_history && declaration.on_cut == HistoryDeclaration::OnCut::invalidate)
    return {record.name, false, 0, HistoryReason::cut};
  return {record.name, record.age > 0, record.age, record.reason};
}

Rectangle Executor::previous_rectangle(const Executor* before) const noexcept {
  return before == nullptr ? state_->previous_rectangle : carried_rectangle(*state_, *before->state_);
}

void Executor::discard_frames() noexcept {
  forget_histories(*state_, HistoryReason::discarded);
  for (Instance& instance : state_->instances)
    instance.ready = false;
  for (uint64_t& frame : state_->timestamps.frame_of_slot)
    frame = 0;
  state_->stand_ins_ready = false;
  state_->previous_rectangle = {};
}

} // namespace dermis::vulkan
