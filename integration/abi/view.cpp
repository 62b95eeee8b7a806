// Implements views: cameras of one graph, each with its own histories.
#include "integration/abi/graph.hpp"
#include "integration/abi/report.hpp"

#include <algorithm>

namespace dermis::abi {
namespace {

// Creates a view of the graph's current compiled graph, which takes over at the first record.
dermis_result create(dermis_graph_t& graph, const dermis_view_desc* given, dermis_view* out,
                     dermis_report* report) {
  const Log& log = graph.context->log;
  dermis_view_desc desc = DERMIS_VIEW_DESC_INIT;
  const SizedRead read = given == nullptr ? SizedRead::ok : read_sized(given, desc);
  if (read != SizedRead::ok)
    return rejected_size(log, read, "dermis_view_create: desc", stated_size(given),
                         sizeof(dermis_view_desc));
  const std::lock_guard changing(graph.changing);
  auto view = std::make_unique<dermis_view_t>(graph.context, &graph, desc.user);
  {
    const std::lock_guard lock(graph.own.mutex);
    const Chooser& from = graph.own.chooser;
    view->chooser.errors = from.errors;
    view->chooser.error_correction = make_error_correction(from.errors);
    view->chooser.calibration = from.calibration;
    view->chooser.costs = from.costs;
    view->chooser.budget = from.budget;
    view->chooser.state.clock_s = from.state.clock_s; // the clock of `costs`
  }
  Diagnostics diagnostics;
  std::shared_ptr<CompiledGraph> compiled_graph;
  const dermis_result made =
      copy_compiled_graph(*graph.context, graph.input, *keep_newest(graph.own),
                          vulkan::HistoryReason::first_frame, diagnostics, compiled_graph);
  const dermis_result result = conclude(log, made, std::move(diagnostics), report);
  if (result != DERMIS_OK) return result;
  drop_own_settings(graph.own, *compiled_graph);
  reserve(view->image_views, compiled_graph->slots.size());
  adopt(view->chooser, graph.context->pass_types, *compiled_graph);
  view->next = compiled_graph;
  retire_other_costs(view->chooser, *compiled_graph);
  {
    const std::lock_guard lock(graph.shared_budget.mutex);
    graph.shared_budget.division.add(view->share);
  }
  graph.others.push_back(std::move(view));
  share_kernels(*compiled_graph);
  *out = graph.others.back().get();
  return DERMIS_OK;
}

} // namespace
} // namespace dermis::abi

using namespace dermis::abi;

extern "C" dermis_result DERMIS_CALL dermis_view_create(dermis_graph graph,
                                                        const dermis_view_desc* desc,
                                                        dermis_view* view, dermis_report* report) {
  constexpr const char* function = "dermis_view_create";
  if (view != nullptr) *view = nullptr;
  if (report != nullptr) *report = nullptr;
  if (graph == nullptr) return bad_argument({}, "{}: graph is NULL", function);
  const Log& log = graph->context->log;
  return guarded(log, function, [&] {
    if (view == nullptr) return bad_argument(log, "{}: view is NULL", function);
    if (const dermis_result alive = check_alive(*graph->context, function); alive != DERMIS_OK)
      return alive;
    return create(*graph, desc, view, report);
  });
}

extern "C" dermis_view DERMIS_CALL dermis_graph_view(dermis_graph graph) {
  return graph == nullptr ? nullptr : &graph->own;
}

extern "C" void DERMIS_CALL dermis_view_destroy(dermis_view view) {
  if (view == nullptr) return;
  dermis_graph_t& graph = *view->graph;
  const std::lock_guard changing(graph.changing);
  std::erase_if(graph.others, [&](const auto& one) { return one.get() == view; });
}

extern "C" dermis_result DERMIS_CALL dermis_view_record(dermis_view view,
                                                        const dermis_frame* frame) {
  constexpr const char* function = "dermis_view_record";
  if (view == nullptr) return bad_argument({}, "{}: view is NULL", function);
  return guarded(view->context->log, function,
                 [&] { return record_frame(*view, function, frame); });
}

extern "C" dermis_result DERMIS_CALL dermis_view_commands(dermis_view view,
                                                          const dermis_frame* frame,
                                                          uint32_t* count,
                                                          const dermis_command** commands) {
  constexpr const char* function = "dermis_view_commands";
  if (view == nullptr) return bad_argument({}, "{}: view is NULL", function);
  return guarded(view->context->log, function,
                 [&] { return capture_frame(*view, function, frame, count, commands); });
}

extern "C" dermis_result DERMIS_CALL dermis_view_discard(dermis_view view, uint64_t frame_index) {
  constexpr const char* function = "dermis_view_discard";
  if (view == nullptr) return bad_argument({}, "{}: view is NULL", function);
  return guarded(view->context->log, function,
                 [&] { return discard_frame(*view, function, frame_index); });
}

extern "C" dermis_result DERMIS_CALL dermis_view_report(dermis_view view,
                                                        uint64_t completed_frame_index,
                                                        dermis_frame_report* report) {
  constexpr const char* function = "dermis_view_report";
  if (view == nullptr) return bad_argument({}, "{}: view is NULL", function);
  return guarded(view->context->log, function,
                 [&] { return get_report(*view, completed_frame_index, report); });
}

extern "C" dermis_result DERMIS_CALL dermis_view_statistics(dermis_view view,
                                                            uint64_t completed_frame_index,
                                                            dermis_frame_statistics* statistics) {
  constexpr const char* function = "dermis_view_statistics";
  if (view == nullptr) return bad_argument({}, "{}: view is NULL", function);
  return guarded(view->context->log, function,
                 [&] { return get_statistics(*view, completed_frame_index, statistics); });
}

extern "C" dermis_result DERMIS_CALL dermis_view_timings(dermis_view view,
                                                         uint64_t completed_frame_index,
                                                         uint32_t* count,
                                                         dermis_pass_timing* timings) {
  constexpr const char* function = "dermis_view_timings";
  if (view == nullptr) return bad_argument({}, "{}: view is NULL", function);
  return guarded(view->context->log, function, [&] {
    return get_timings(*view, function, completed_frame_index, count, timings);
  });
}

extern "C" dermis_result DERMIS_CALL dermis_view_histories(dermis_view view, uint32_t* count,
                                                           dermis_history* histories) {
  constexpr const char* function = "dermis_view_histories";
  if (view == nullptr) return bad_argument({}, "{}: view is NULL", function);
  return guarded(view->context->log, function,
                 [&] { return get_histories(*view, function, count, histories); });
}
