#include "integration/abi/graph.hpp"

#include "integration/abi/graph_desc.hpp"
#include "integration/abi/report.hpp"

#include <algorithm>

dermis_view_t::~dermis_view_t() {
  const std::lock_guard lock(graph->shared_budget.mutex);
  graph->shared_budget.division.remove(share);
}

dermis_graph_t::dermis_graph_t(dermis_context owner) : context(owner), own(owner, this, nullptr) {
  shared_budget.division.add(own.share);
  const std::lock_guard lock(context->mutex);
  context->graphs.push_back(this);
}

dermis_graph_t::~dermis_graph_t() {
  const std::lock_guard lock(context->mutex);
  std::erase(context->graphs, this);
}

namespace dermis::abi {
namespace {

using Candidates =
    std::vector<std::shared_ptr<CompiledGraph>>; // by view, the graph's own view first

// Reports each history of `compiled_graph` that cannot continue from the view's last frame.
// Requires the view's mutex.
void report_lost_histories(const dermis_view_t& view, const CompiledGraph& compiled_graph,
                           vulkan::HistoryReason reason, Diagnostics& diagnostics) {
  const CompiledGraph& last = *view.running;
  const vulkan::Executor& before = *last.recorded().executor;
  const vulkan::Executor& executor = *compiled_graph.current().executor;
  const Plan& plan = compiled_graph.current().compiled->plan;
  for (uint32_t h = 0; h < plan.histories.size(); ++h) {
    if (executor.history_state(h, false, &before).valid) continue;
    const ResourceDeclaration& declared =
        compiled_graph.graph.resources[plan.resources[plan.histories[h].resource].declared.value];
    diagnostics.add(DiagnosticId::history_restarts, declared.where,
                    fmt::format("history '{}' restarts: {}", declared.name,
                                vulkan::history_reason_text(reason)));
  }
}

// Builds a compiled graph for every view next to the running one. Changes nothing visible to the
// views.
dermis_result build_candidates(dermis_graph_t& graph, CompiledGraphInput& input,
                               vulkan::HistoryReason reason, Diagnostics& diagnostics,
                               Candidates& candidates) {
  dermis_context_t& context = *graph.context;
  bool recorded = false;
  for_each_view(graph, [&](const dermis_view_t& view) {
    const std::lock_guard lock(view.mutex);
    recorded = recorded || view.last_frame > 0;
  });
  const vulkan::HistoryReason history = recorded ? reason : vulkan::HistoryReason::first_frame;
  choice::ErrorModel errors;
  choice::CostEstimator costs;
  { // recording may learn concurrently
    const std::lock_guard lock(graph.own.mutex);
    errors = graph.own.chooser.errors;
    costs = graph.own.chooser.costs;
  }
  candidates.resize(1 + graph.others.size());
  dermis_result result = build_compiled_graph(context, input, history, graph.plans, errors, costs,
                                              diagnostics, candidates[0]);
  for (size_t v = 1; v < candidates.size() && result == DERMIS_OK; ++v)
    result =
        copy_compiled_graph(context, input, *candidates[0], history, diagnostics, candidates[v]);
  for (size_t v = 1; v < candidates.size() && result == DERMIS_OK; ++v)
    apply_own_settings(*graph.others[v - 1], *candidates[v], diagnostics);
  if (result == DERMIS_OK) apply_own_settings(graph.own, *candidates[0], diagnostics);
  // the caller handles errors of profiles
  if (result != DERMIS_OK || diagnostics.has_errors()) return result;
  size_t v = 0;
  bool reported = false; // views share the declarations, so one report is enough
  for_each_view(graph, [&](dermis_view_t& view) {
    const std::lock_guard lock(view.mutex);
    if (!reported && view.running && view.running->last_frame > 0) {
      report_lost_histories(view, *candidates[v], reason, diagnostics);
      reported = true;
    }
    reserve(view.image_views, candidates[v]->slots.size());
    adopt(view.chooser, context.pass_types, *candidates[v++]);
  });
  return DERMIS_OK;
}

// Makes the candidates take over at the next record of each view. A compiled graph that was still
// waiting was never recorded.
void hand_over(dermis_graph_t& graph, Candidates& candidates) noexcept {
  for (const std::shared_ptr<CompiledGraph>& candidate : candidates)
    share_kernels(*candidate); // before any view is locked, so that recording does not wait
  size_t v = 0;
  for_each_view(graph, [&](dermis_view_t& view) {
    const std::lock_guard lock(view.mutex);
    view.next.swap(candidates[v++]);
    retire_other_costs(view.chooser, *view.next);
  });
}

dermis_result create(dermis_context context, const dermis_graph_desc* given, dermis_graph* out,
                     dermis_report* report) {
  const Log& log = context->log;
  dermis_graph_desc desc = DERMIS_GRAPH_DESC_INIT;
  if (const SizedRead read = read_sized(given, desc); read != SizedRead::ok)
    return rejected_size(log, read, "dermis_graph_create: desc", stated_size(given),
                         sizeof(dermis_graph_desc));
  if (desc.keep != 0)
    return bad_argument(
        log, "dermis_graph_create: desc.keep is {:#x}, expected 0: only a reload can keep",
        desc.keep);
  auto graph = std::make_unique<dermis_graph_t>(context);
  Diagnostics diagnostics;
  if (const dermis_result result =
          read_graph_desc(log, "dermis_graph_create", desc, graph->input, diagnostics);
      result != DERMIS_OK)
    return result;
  Candidates candidates;
  dermis_result result = build_candidates(*graph, graph->input, vulkan::HistoryReason::first_frame,
                                          diagnostics, candidates);
  // error of a profile
  if (result == DERMIS_OK && diagnostics.has_errors()) result = DERMIS_ERROR_CONFIG;
  result = conclude(log, result, std::move(diagnostics), report);
  if (result != DERMIS_OK) return result;
  hand_over(*graph, candidates);
  *out = graph.release();
  return DERMIS_OK;
}

// Rebuilds the graph from its stored input and the parts that the description replaces.
dermis_result reload(dermis_graph_t& graph, const dermis_graph_desc* given, dermis_report* report) {
  constexpr const char* function = "dermis_graph_reload";
  const Log& log = graph.context->log;
  dermis_graph_desc desc = DERMIS_GRAPH_DESC_INIT;
  if (const SizedRead read = read_sized(given, desc); read != SizedRead::ok)
    return rejected_size(log, read, "dermis_graph_reload: desc", stated_size(given),
                         sizeof(dermis_graph_desc));
  const std::lock_guard changing(graph.changing);
  CompiledGraphInput input = graph.input;
  input.included.clear(); // files may have changed
  Diagnostics diagnostics;
  if (const dermis_result result = read_graph_desc(log, function, desc, input, diagnostics);
      result != DERMIS_OK)
    return result;
  const bool resized = input.width != graph.input.width || input.height != graph.input.height ||
                       input.pixel_grid != graph.input.pixel_grid;
  return replace_compiled_graphs(graph, std::move(input),
                                 resized ? vulkan::HistoryReason::resized
                                         : vulkan::HistoryReason::reloaded,
                                 report, std::move(diagnostics));
}

} // namespace

double budget_of_view(const dermis_view_t& view) {
  const Budget& budget = view.chooser.budget;
  if (!budget.all_views || budget.ms <= 0) return budget.ms;
  SharedBudget& shared = view.graph->shared_budget;
  const std::lock_guard lock(shared.mutex);
  return shared.division.present_share(view.share, budget.ms);
}

dermis_result replace_compiled_graphs(dermis_graph_t& graph, CompiledGraphInput&& input,
                                      vulkan::HistoryReason reason, dermis_report* report,
                                      Diagnostics&& diagnostics) {
  Candidates candidates;
  const dermis_result built = build_candidates(graph, input, reason, diagnostics, candidates);
  const dermis_result result = conclude(graph.context->log, built, std::move(diagnostics), report);
  if (result != DERMIS_OK) return result;
  hand_over(graph, candidates);
  graph.input = std::move(input);
  return result;
}

} // namespace dermis::abi

using namespace dermis::abi;

extern "C" dermis_result DERMIS_CALL dermis_graph_create(dermis_context context,
                                                         const dermis_graph_desc* desc,
                                                         dermis_graph* graph,
                                                         dermis_report* report) {
  if (graph != nullptr) *graph = nullptr;
  if (report != nullptr) *report = nullptr;
  if (context == nullptr) return bad_argument({}, "dermis_graph_create: context is NULL");
  return guarded(context->log, "dermis_graph_create", [&] {
    if (desc == nullptr) return bad_argument(context->log, "dermis_graph_create: desc is NULL");
    if (graph == nullptr) return bad_argument(context->log, "dermis_graph_create: graph is NULL");
    if (const dermis_result alive = check_alive(*context, "dermis_graph_create");
        alive != DERMIS_OK)
      return alive;
    return create(context, desc, graph, report);
  });
}

extern "C" dermis_result DERMIS_CALL dermis_graph_reload(dermis_graph graph,
                                                         const dermis_graph_desc* desc,
                                                         dermis_report* report) {
  if (report != nullptr) *report = nullptr;
  if (graph == nullptr) return bad_argument({}, "dermis_graph_reload: graph is NULL");
  const Log& log = graph->context->log;
  return guarded(log, "dermis_graph_reload", [&] {
    if (desc == nullptr) return bad_argument(log, "dermis_graph_reload: desc is NULL");
    if (const dermis_result alive = check_alive(*graph->context, "dermis_graph_reload");
        alive != DERMIS_OK)
      return alive;
    return reload(*graph, desc, report);
  });
}

extern "C" dermis_result DERMIS_CALL dermis_graph_resize(dermis_graph graph, uint32_t width,
                                                         uint32_t height, dermis_report* report) {
  if (report != nullptr) *report = nullptr;
  if (graph == nullptr) return bad_argument({}, "dermis_graph_resize: graph is NULL");
  const Log& log = graph->context->log;
  return guarded(log, "dermis_graph_resize", [&] {
    if (const dermis_result result = check_view_size(log, "dermis_graph_resize", width, height);
        result != DERMIS_OK)
      return result;
    if (const dermis_result alive = check_alive(*graph->context, "dermis_graph_resize");
        alive != DERMIS_OK)
      return alive;
    const std::lock_guard changing(graph->changing);
    CompiledGraphInput input = graph->input;
    input.width = width;
    input.height = height;
    return replace_compiled_graphs(*graph, std::move(input), dermis::vulkan::HistoryReason::resized,
                                   report);
  });
}

extern "C" void DERMIS_CALL dermis_graph_destroy(dermis_graph graph) {
  delete graph;
}
