// Tracks age, validity and invalidation reason of the executor's histories.
#include "framegraph/vulkan/executor/state.hpp"

namespace dermis::vulkan {
namespace {

// Returns why no history was copied from another plan: the reason the executor was created for, if
// it has never run, else `switched`.
HistoryReason not_carried(const HistoryRecord& record) noexcept {
  const bool replaced =
      record.reason == HistoryReason::reloaded || record.reason == HistoryReason::resized;
  return replaced && record.age == 0 ? record.reason : HistoryReason::switched;
}

} // namespace

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
  case HistoryReason::switched:
    return "frames ran with another plan";
  case HistoryReason::left_out:
    return "a frame ran without the passes that write it";
  }
  return "unknown";
}

const char* valid_since_text(HistoryReason lost) {
  switch (lost) {
  case HistoryReason::cut:
    return "valid since a camera cut";
  case HistoryReason::resized:
    return "valid since the view was resized";
  case HistoryReason::reloaded:
    return "valid since the graph was reloaded";
  case HistoryReason::switched:
    return "valid again after frames with another plan";
  case HistoryReason::left_out:
    return "valid again after a frame without the passes that write it";
  case HistoryReason::valid:
  case HistoryReason::first_frame:
    break;
  }
  return "valid since its first frame";
}

uint32_t access_now(const State& state, const PortAccess& port) noexcept {
  if (port.history == no_index) return port.access;
  const bool valid =
      state.histories[port.history].age >= state.plan.accesses[port.access].frames_back;
  return valid ? port.access : port.otherwise;
}

void invalidate_history(HistoryRecord& history, HistoryReason reason) noexcept {
  history.age = 0;
  history.reason = history.lost = reason;
}

void invalidate_histories(State& state, HistoryReason reason) noexcept {
  for (size_t h = 0; h < state.histories.size(); ++h) {
    HistoryRecord& history = state.histories[h];
    invalidate_history(history, reason == HistoryReason::switched ? not_carried(history) : reason);
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
    const HistoryReason lost = not_carried(record);
    if (carried.age == 0) return {record.name, false, 0, lost, lost};
    return {record.name, true, carried.age, HistoryReason::valid,
            before->state_->histories[carried.history].lost};
  }
  const HistoryDeclaration& declaration = state_->plan.histories[index].declaration;
  if (reset_history && declaration.on_cut == HistoryDeclaration::OnCut::invalidate)
    return {record.name, false, 0, HistoryReason::cut, HistoryReason::cut};
  return {record.name, record.age > 0, record.age, record.reason, record.lost};
}

Rectangle Executor::previous_rectangle(const Executor* before) const noexcept {
  return before == nullptr ? state_->previous_rectangle
                           : carried_rectangle(*state_, *before->state_);
}

void save_snapshot(State& state) noexcept {
  std::swap(state.snapshot, state.earlier_snapshot);
  FrameSnapshot& snapshot = state.snapshot;
  for (size_t h = 0; h < state.histories.size(); ++h)
    snapshot.histories[h] = {state.histories[h].age, state.histories[h].reason,
                             state.histories[h].lost};
  for (size_t i = 0; i < state.instances.size(); ++i)
    snapshot.ready[i] = state.instances[i].ready;
  snapshot.placeholders_ready = state.placeholders_ready;
  snapshot.copied_tables.reset();
  snapshot.previous_rectangle = state.previous_rectangle;
  snapshot.last_frame_index = state.last_frame_index;
  snapshot.is_valid = true;
}

bool Executor::discard_frame(uint64_t frame_index) noexcept {
  State& state = *state_;
  FrameSnapshot& snapshot = state.snapshot;
  if (!snapshot.is_valid || state.last_frame_index != frame_index) return false;
  const auto frame_slot = static_cast<uint32_t>(frame_index % state.frames_in_flight);
  for (size_t h = 0; h < state.histories.size(); ++h) {
    state.histories[h].age = snapshot.histories[h].age;
    state.histories[h].reason = snapshot.histories[h].reason;
    state.histories[h].lost = snapshot.histories[h].lost;
  }
  for (size_t i = 0; i < state.instances.size(); ++i)
    state.instances[i].ready = snapshot.ready[i] != 0;
  state.placeholders_ready = snapshot.placeholders_ready;
  if (snapshot.copied_tables != nullptr) snapshot.copied_tables->state().is_copied = false;
  snapshot.copied_tables.reset();
  state.previous_rectangle = snapshot.previous_rectangle;
  state.last_frame_index = snapshot.last_frame_index;
  state.frame_of_slot[frame_slot] = 0; // recording cleared the counters of the slot's earlier frame
  if (state.timestamps.pool != VK_NULL_HANDLE) state.timestamps.frame_of_slot[frame_slot] = 0;
  --state.frame_counter;
  snapshot.is_valid = false;
  state.earlier_snapshot.is_valid = false;
  return true;
}

void Executor::undo_last_record(uint64_t frame_index) noexcept {
  const bool earlier_is_valid = state_->earlier_snapshot.is_valid;
  if (!discard_frame(frame_index)) return;
  state_->earlier_snapshot.is_valid = earlier_is_valid;
  std::swap(state_->snapshot, state_->earlier_snapshot);
}

} // namespace dermis::vulkan
