#include "integration/abi/error_learning.hpp"
#include "integration/abi/frame_check.hpp"

#include <algorithm>
#include <array>

namespace dermis::abi {
namespace {

// Returns the time since the frame before. A longer pause changes no decision, and an absurd value
// would make the clock too large for the times of later frames.
double seconds_of(const dermis_frame& frame) {
  constexpr double longest_pause_s = 3600;
  return std::min(double(frame.delta_seconds), longest_pause_s);
}

// Destroys replaced compiled graphs whose last frame the device has finished.
void collect(dermis_view_t& view, uint64_t completed) {
  for (auto& old : view.retired)
    if (old && old->last_frame <= completed) old.reset();
  if (view.running)
    for (const RunnablePlan& plan : view.running->plans) {
      plan.executor->release_tables(completed);
      plan.executor->release_pipelines(completed);
    }
}

void take_over(dermis_view_t& view) {
  view.recorded.took_over = view.next != nullptr;
  view.recorded.retired = view.retired.size();
  if (!view.next) return;
  if (view.running && view.running->last_frame > 0)
    for (size_t i = 0; i < view.retired.size() && view.running; ++i)
      if (!view.retired[i]) {
        view.retired[i] = std::move(view.running);
        view.recorded.retired = i;
      }
  view.running = std::move(view.next);
}

// The view's next frame replaces one that was not recorded or that was discarded.
void repeat_share(dermis_view_t& view) {
  const std::lock_guard lock(view.graph->shared_budget.mutex);
  view.graph->shared_budget.division.repeat(view.share);
}

// Restores the state before the frame was recorded. Host memory is not released.
dermis_result discard(dermis_view_t& view, const char* function, uint64_t frame_index) {
  const Log& log = view.context->log;
  dermis_view_t::Recorded& recorded = view.recorded;
  if (!recorded.known)
    return bad_argument(log,
                        "{}: no frame can be discarded: none was recorded since the view was "
                        "created or the last frame was discarded",
                        function);
  if (frame_index != view.last_frame)
    return bad_argument(log, "{}: frame_index is {}, expected that of the frame recorded last, {}",
                        function, frame_index, view.last_frame);
  if (recorded.took_over && view.next)
    return bad_argument(
        log,
        "{}: the graph was reloaded or resized since frame {}, which was the first of the "
        "graph before that: it "
        "can no longer be discarded",
        function, frame_index);
  CompiledGraph& compiled_graph = *view.running;
  if (!compiled_graph.plans[recorded.plan].executor->discard_frame(frame_index))
    return bad_argument(log, "{}: frame {} was not recorded", function, frame_index);
  compiled_graph.plans[recorded.plan].recorded = recorded.plan_recorded;
  compiled_graph.last_frame = recorded.compiled_graph_last_frame;
  compiled_graph.last_jitter_px = recorded.last_jitter_px;
  compiled_graph.configuration = recorded.configuration;
  compiled_graph.plan = recorded.compiled_graph_plan;
  discard_choice(view.chooser, frame_index);
  repeat_share(view);
  if (recorded.took_over) {
    view.next = std::move(view.running);
    if (recorded.retired < view.retired.size())
      view.running = std::move(view.retired[recorded.retired]);
  }
  view.last_frame = recorded.last_frame;
  view.frames = recorded.frames;
  recorded = {};
  return DERMIS_OK;
}

// Returns the jitter of the previous frame, in pixels of the current view size.
std::array<double, 2> rescaled_jitter(const dermis_view_t& view, const vulkan::Executor& executor,
                                      const vulkan::Executor& before) {
  const vulkan::Rectangle was = before.previous_rectangle(),
                          is = executor.previous_rectangle(&before);
  const auto& jitter = view.running->last_jitter_px;
  return {jitter[0] * is.width / std::max(was.width, 1u),
          jitter[1] * is.height / std::max(was.height, 1u)};
}

uint32_t plan_of(const CompiledGraph& compiled_graph, uint32_t configuration, bool empty_bounds) {
  const uint32_t plan = compiled_graph.configurations[configuration].plan;
  const uint32_t instead = compiled_graph.plans[plan].without_bounds;
  return empty_bounds && instead != no_plan ? instead : plan;
}

dermis_result record_chosen(dermis_view_t& view, CompiledGraph& compiled_graph, FrameChoice& chosen,
                            const dermis_frame& frame, CheckedFrame& checked, Capture* capture) {
  const Log& log = view.context->log;
  const uint32_t plan = plan_of(compiled_graph, chosen.configuration, checked.empty_bounds());
  chosen.plan = plan;
  chosen.begins = !compiled_graph.plans[plan].recorded || compiled_graph.last_frame == 0 ||
                  chosen.configuration != compiled_graph.configuration;
  const vulkan::Executor* before = recorded_before(view, compiled_graph, plan);
  const std::array<double, 2> jitter_before = compiled_graph.last_jitter_px;
  const bool replaces = compiled_graph.last_frame == 0 && before != nullptr;
  if (replaces)
    compiled_graph.last_jitter_px =
        rescaled_jitter(view, *compiled_graph.plans[plan].executor, *before);
  if (const dermis_result result = fill_frame(
          view, compiled_graph,
          {chosen.configuration, plan, before, chosen.sample_units, chosen.probed}, frame, checked);
      result != DERMIS_OK)
    return result;
  chosen.left_out = checked.empty_bounds();
  chosen.history_invalid = checked.history_invalid;
  chosen.history_unread = checked.history_unread;
  if (chosen.history_invalid)
    restart_histories(chosen, compiled_graph.configurations[chosen.configuration]);
  if (chosen.left_out) chosen.decision.expected_ms = chosen.decision.bound_ms = 0;
  collect(view, frame.completed_frame_index);
  if (capture != nullptr) capture_into(*capture, checked.input);
  if (const vulkan::RecordResult error =
          compiled_graph.plans[plan].executor->record(checked.input)) {
    if (error.kind == vulkan::ErrorKind::device_lost) view.context->lost = true;
    const bool has_slot =
        error.slot >= 0 && static_cast<size_t>(error.slot) < compiled_graph.slots.size();
    return fail(log, result_of(error.kind), diagnostic_of(error.kind), "{}: {}{}{}{}",
                view.function, error.text, has_slot ? " (slot '" : "",
                has_slot ? compiled_graph.slots[static_cast<size_t>(error.slot)].name : "",
                has_slot ? "')" : "");
  }
  if (capture != nullptr && capture->failed) {
    compiled_graph.plans[plan].executor->undo_last_record(frame.frame_index);
    compiled_graph.last_jitter_px = jitter_before;
    return fail(log, DERMIS_ERROR_MEMORY, DiagnosticId::host_memory, "{}: out of host memory",
                view.function);
  }
  view.recorded = {};
  view.recorded.known = true;
  view.recorded.last_frame = view.last_frame;
  view.recorded.frames = view.frames;
  view.recorded.compiled_graph_last_frame = compiled_graph.last_frame;
  view.recorded.last_jitter_px = jitter_before;
  view.recorded.configuration = compiled_graph.configuration;
  view.recorded.compiled_graph_plan = compiled_graph.plan;
  view.recorded.plan = plan;
  view.recorded.plan_recorded = compiled_graph.plans[plan].recorded;
  // its histories are copied by this frame
  if (replaces) view.running->last_frame = frame.frame_index;
  compiled_graph.last_frame = frame.frame_index;
  compiled_graph.last_jitter_px = {frame.jitter_x, frame.jitter_y};
  compiled_graph.configuration = chosen.configuration;
  compiled_graph.plan = plan;
  compiled_graph.plans[plan].recorded = true;
  remember(view.chooser, chosen);
  view.last_frame = frame.frame_index;
  view.frames = checked.constants.view_frame;
  take_over(view);
  return DERMIS_OK;
}

// `capture` receives the commands instead of the frame's command buffer; may be null.
dermis_result record(dermis_view_t& view, const dermis_frame* given, Capture* capture) {
  const Log& log = view.context->log;
  if (const dermis_result alive = check_alive(*view.context, view.function); alive != DERMIS_OK)
    return alive;
  dermis_frame frame = DERMIS_FRAME_INIT;
  if (const SizedRead read = read_sized(given, frame); read != SizedRead::ok)
    return rejected_size(log, read, view.function, "frame", stated_size(given),
                         sizeof(dermis_frame));
  if (capture != nullptr) frame.command_buffer = handle_of(*capture);
  CompiledGraph& compiled_graph = newest(view);
  CheckedFrame checked;
  if (const dermis_result result = check_frame(view, compiled_graph, frame, checked);
      result != DERMIS_OK)
    return result;
  Chooser& chooser = view.chooser;
  if (view.running) observe(chooser, *view.running, frame.completed_frame_index);
  if (const dermis_result loss = check_loss(view, view.function); loss != DERMIS_OK) return loss;
  const bool cut = (frame.flags & DERMIS_FRAME_RESET_HISTORY) != 0;
  FrameChoice chosen = choose(chooser, compiled_graph,
                              {frame.frame_index, seconds_of(frame), cut, checked.empty_bounds(),
                               checked.input.rectangle, &view.graph->shared_budget, &view.share});
  const dermis_result result = record_chosen(view, compiled_graph, chosen, frame, checked, capture);
  if (result != DERMIS_OK) repeat_share(view);
  return result;
}

} // namespace

const vulkan::Executor* recorded_before(const dermis_view_t& view,
                                        const CompiledGraph& compiled_graph, uint32_t plan) {
  const bool first = compiled_graph.last_frame == 0;
  if (first && (!view.next || !view.running)) return nullptr;
  const CompiledGraph& other = first ? *view.running : compiled_graph;
  const uint32_t last = other.plan;
  if (other.last_frame == 0 || (!first && last == plan)) return nullptr;
  return other.plans[last].executor.get();
}

dermis_result check_loss(const dermis_view_t& view, const char* function) {
  if (view.running)
    for (const RunnablePlan& plan : view.running->plans)
      if (plan.executor->saw_lost_device()) view.context->lost = true;
  return check_alive(*view.context, function);
}

dermis_result record_frame(dermis_view_t& view, const char* function, const dermis_frame* frame) {
  if (frame == nullptr) return bad_argument(view.context->log, "{}: frame is NULL", function);
  const std::lock_guard lock(view.mutex);
  view.function = function;
  return record(view, frame, nullptr);
}

dermis_result capture_frame(dermis_view_t& view, const char* function, const dermis_frame* frame,
                            uint32_t* count, const dermis_command** commands) {
  const Log& log = view.context->log;
  if (frame == nullptr) return bad_argument(log, "{}: frame is NULL", function);
  if (count == nullptr) return bad_argument(log, "{}: count is NULL", function);
  if (commands == nullptr) return bad_argument(log, "{}: commands is NULL", function);
  *count = 0;
  *commands = nullptr;
  const std::lock_guard lock(view.mutex);
  view.function = function;
  clear(view.capture);
  const dermis_result result = record(view, frame, &view.capture);
  if (result != DERMIS_OK) return result;
  *count = static_cast<uint32_t>(view.capture.commands.size());
  *commands = view.capture.commands.data();
  return DERMIS_OK;
}

dermis_result discard_frame(dermis_view_t& view, const char* function, uint64_t frame_index) {
  const std::lock_guard lock(view.mutex);
  return discard(view, function, frame_index);
}

} // namespace dermis::abi
