#include "integration/abi/frame_check.hpp"

#include <algorithm>
#include <array>

namespace dermis::abi {
namespace {

// Destroys replaced programs whose last frame the device has finished.
void collect(dermis_graph_t& graph, uint64_t completed) {
  for (auto& old : graph.retired)
    if (old && old->last_frame <= completed) old.reset();
}

void take_over(dermis_graph_t& graph) {
  graph.recorded.took_over = graph.next != nullptr;
  graph.recorded.retired = graph.retired.size();
  if (!graph.next) return;
  if (graph.running && graph.running->last_frame > 0)
    for (size_t i = 0; i < graph.retired.size() && graph.running; ++i)
      if (!graph.retired[i]) {
        graph.retired[i] = std::move(graph.running);
        graph.recorded.retired = i;
      }
  graph.running = std::move(graph.next);
}

// As if the frame had not been recorded. Host memory stays as it is.
dermis_result discard(dermis_graph_t& graph, uint64_t frame_index) {
  const Log& log = graph.context->log;
  dermis_graph_t::Recorded& recorded = graph.recorded;
  if (!recorded.known || frame_index != graph.last_frame)
    return bad_argument(
        log, "dermis_frame_discard: frame_index is {}, expected that of the frame recorded last, {}{}",
        frame_index, graph.last_frame,
        recorded.known || graph.last_frame == 0 ? "" : ", which can be taken back once and alone");
  if (recorded.took_over && graph.next)
    return bad_argument(
        log,
        "dermis_frame_discard: the graph was reloaded or resized since frame {}, which was the "
        "first of the graph before that: it cannot be taken back any more",
        frame_index);
  Program& program = *graph.running;
  if (!program.variants[recorded.variant].executor->discard_frame(frame_index))
    return bad_argument(log, "dermis_frame_discard: frame {} was not recorded", frame_index);
  program.last_frame = recorded.program_last_frame;
  program.last_jitter_px = recorded.last_jitter_px;
  program.outcome = recorded.outcome;
  forget(graph.chooser, frame_index);
  graph.chooser.state = recorded.decision;
  graph.chooser.decided_for = recorded.decided_for;
  if (recorded.took_over) {
    graph.next = std::move(graph.running);
    if (recorded.retired < graph.retired.size()) graph.running = std::move(graph.retired[recorded.retired]);
    if (graph.running) graph.running->last_frame = recorded.replaced_last_frame;
  }
  graph.last_frame = recorded.last_frame;
  recorded = {};
  return DERMIS_OK;
}

// Who recorded the frame before, where that was another plan: of this program, or of the one that it
// replaces.
const vulkan::Executor* recorded_before(const dermis_graph_t& graph, const Program& program,
                                        uint32_t variant) {
  const bool first = program.last_frame == 0;
  if (first && (!graph.next || !graph.running)) return nullptr;
  const Program& other = first ? *graph.running : program;
  const uint32_t last = other.outcomes[other.outcome].plan;
  if (other.last_frame == 0 || (!first && last == variant)) return nullptr;
  return other.variants[last].executor.get();
}

// The jitter of the frame before, in pixels of the size that the view has now.
std::array<double, 2> rescaled_jitter(const dermis_graph_t& graph, const vulkan::Executor& executor,
                                      const vulkan::Executor& before) {
  const vulkan::Rectangle was = before.previous_rectangle(), is = executor.previous_rectangle(&before);
  const auto& jitter = graph.running->last_jitter_px;
  return {jitter[0] * is.width / std::max(was.width, 1u), jitter[1] * is.height / std::max(was.height, 1u)};
}

constexpr uint64_t tile_side = 8, block_side = 32; // pixels

// Squares of `side` pixels.
uint64_t squares_of(const vulkan::Rectangle& rectangle, uint64_t side) {
  return (rectangle.width + side - 1) / side * ((rectangle.height + side - 1) / side);
}

dermis_result record(dermis_graph_t& graph, const dermis_frame* given) {
  const Log& log = graph.context->log;
  if (const dermis_result alive = check_alive(*graph.context, "dermis_graph_record"); alive != DERMIS_OK)
    return alive;
  dermis_frame frame = DERMIS_FRAME_INIT;
  if (const SizedRead read = read_sized(given, frame); read != SizedRead::ok)
    return refused_size(log, read, "dermis_graph_record: frame", stated_size(given),
                        first_version_size<dermis_frame>);
  Program& program = newest(graph);
  CheckedFrame checked;
  if (const dermis_result result = check_frame(graph, program, frame, checked); result != DERMIS_OK)
    return result;
  Chooser& chooser = graph.chooser;
  if (graph.running) observe(chooser, *graph.running, frame.completed_frame_index);
  choice::DecisionState state =
      program.serial == chooser.decided_for ? chooser.state : choice::DecisionState{};
  const vulkan::Rectangle& seen = checked.input.rectangle;
  FrameChoice chosen = choose(chooser, program, squares_of(seen, tile_side), squares_of(seen, block_side),
                              chooser.forecasts, state);
  if (!chooser.counted) state = {}; // decided for a view full of subsurface: no reason to stay
  chosen.frame_index = frame.frame_index;
  const uint32_t variant = program.outcomes[chosen.outcome].plan;
  chosen.first_of_plan = !program.variants[variant].recorded;
  const vulkan::Executor* before = recorded_before(graph, program, variant);
  const std::array<double, 2> jitter_before = program.last_jitter_px;
  const bool replaces = program.last_frame == 0 && before != nullptr;
  if (replaces) program.last_jitter_px = rescaled_jitter(graph, *program.variants[variant].executor, *before);
  if (const dermis_result result =
          fill_frame(graph, program, chosen.outcome, before, chosen.sample_units, frame, checked);
      result != DERMIS_OK)
    return result;
  chosen.left_out = !checked.input.left_out.empty();
  chosen.history_invalid = checked.history_invalid;
  if (chosen.left_out) chosen.forecast.ms = chosen.forecast.spread_ms = 0;
  collect(graph, frame.completed_frame_index);
  if (const vulkan::RecordResult error = program.variants[variant].executor->record(checked.input)) {
    if (error.kind == vulkan::ErrorKind::device_lost) graph.context->lost = true;
    const bool has_slot = error.slot >= 0 && static_cast<size_t>(error.slot) < program.slots.size();
    return fail(log, result_of(error.kind), diagnostic_of(error.kind), "dermis_graph_record: {}{}{}{}",
                error.text, has_slot ? " (slot '" : "",
                has_slot ? program.slots[static_cast<size_t>(error.slot)].name : "", has_slot ? "')" : "");
  }
  graph.recorded = {};
  graph.recorded.known = true;
  graph.recorded.last_frame = graph.last_frame;
  graph.recorded.replaced_last_frame = graph.running ? graph.running->last_frame : 0;
  graph.recorded.program_last_frame = program.last_frame;
  graph.recorded.last_jitter_px = jitter_before;
  graph.recorded.outcome = program.outcome;
  graph.recorded.variant = variant;
  graph.recorded.decision = chooser.state;
  graph.recorded.decided_for = chooser.decided_for;
  if (replaces) graph.running->last_frame = frame.frame_index; // whose histories it copies
  program.last_frame = frame.frame_index;
  program.last_jitter_px = {frame.jitter_x, frame.jitter_y};
  program.outcome = chosen.outcome;
  program.variants[variant].recorded = true;
  remember(chooser, chosen, state);
  graph.last_frame = frame.frame_index;
  take_over(graph);
  return DERMIS_OK;
}

} // namespace
} // namespace dermis::abi

using namespace dermis::abi;

extern "C" dermis_result DERMIS_CALL dermis_graph_record(dermis_graph graph, const dermis_frame* frame) {
  if (graph == nullptr) return bad_argument({}, "dermis_graph_record: graph is NULL");
  const Log& log = graph->context->log;
  return guarded(log, "dermis_graph_record", [&] {
    if (frame == nullptr) return bad_argument(log, "dermis_graph_record: frame is NULL");
    return record(*graph, frame);
  });
}

extern "C" dermis_result DERMIS_CALL dermis_frame_discard(dermis_graph graph, uint64_t frame_index) {
  if (graph == nullptr) return bad_argument({}, "dermis_frame_discard: graph is NULL");
  return guarded(graph->context->log, "dermis_frame_discard", [&] { return discard(*graph, frame_index); });
}
