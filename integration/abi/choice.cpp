// Implements budgets, descriptions of the choice, and calibration.

#include "framegraph/text/document.hpp"
#include "integration/abi/graph.hpp"
#include "integration/abi/graph_desc.hpp"
#include "integration/abi/report.hpp"
#include "passes/choice/missing_rows.hpp"
#include "passes/common/probe.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace dermis::abi {
namespace {

constexpr float min_percentile = 0.5f, max_percentile = 0.99f;
constexpr float max_uncertainty = 100;
constexpr uint32_t known_flags = DERMIS_BUDGET_DETERMINISTIC | DERMIS_BUDGET_TRIALS_AT_CUTS |
                                 DERMIS_BUDGET_NO_TRIALS | DERMIS_BUDGET_ALL_VIEWS;

struct Tables {
  std::optional<choice::ErrorModel> errors;
  std::optional<choice::Calibration> calibration;
};

dermis_result read_tables(const Log& log, const dermis_budget& budget, Tables& out,
                          Diagnostics& diagnostics) {
  std::string name, text;
  if (budget.errors != nullptr) {
    if (const dermis_result result =
            read_source(log, "dermis_graph_set_budget: errors", *budget.errors, name, text);
        result != DERMIS_OK)
      return result;
    const auto document =
        parse_document(name.empty() ? "errors" : name, std::move(text), diagnostics);
    if (document) out.errors = choice::read_error_model(*document, diagnostics);
  }
  if (budget.calibration != nullptr) {
    if (const dermis_result result = read_source(log, "dermis_graph_set_budget: calibration",
                                                 *budget.calibration, name, text);
        result != DERMIS_OK)
      return result;
    const auto document =
        parse_document(name.empty() ? "calibration" : name, std::move(text), diagnostics);
    if (document) out.calibration = choice::read_calibration(*document, diagnostics);
  }
  return DERMIS_OK;
}

// Holds the parts of a view that depend on new tables. Keeps references to the compiled graphs,
// because recording may replace `running` by `next` meanwhile.
struct ViewTables {
  choice::ErrorModel errors;
  choice::ErrorCorrection error_correction;
  choice::Calibration calibration;
  choice::CostEstimator costs;
  struct Described {
    std::shared_ptr<CompiledGraph> compiled_graph; // may be null
    std::vector<choice::Configuration> configurations;
  };
  // The running and the next one, and the one that runs again if the last record is discarded.
  std::array<Described, 3> compiled_graphs;
};

ViewTables tables_of(const dermis_view_t& view, const Tables& given) {
  ViewTables out;
  const Chooser& now = view.chooser;
  out.errors = given.errors ? *given.errors : now.errors;
  out.error_correction = given.errors ? make_error_correction(out.errors) : now.error_correction;
  out.calibration = given.calibration ? *given.calibration : now.calibration;
  out.costs = given.calibration
                  ? choice::CostEstimator(out.calibration.costs, out.calibration.uncertainty)
                  : now.costs;
  out.compiled_graphs[0].compiled_graph = view.running;
  out.compiled_graphs[1].compiled_graph = view.next;
  if (view.recorded.took_over && view.recorded.retired < view.retired.size())
    out.compiled_graphs[2].compiled_graph = view.retired[view.recorded.retired];
  for (auto& [compiled_graph, configurations] : out.compiled_graphs)
    if (compiled_graph)
      configurations = described(view.context->pass_types, *compiled_graph, out.errors, out.costs,
                                 compiled_graph->configurations);
  return out;
}

// Reports what new tables lack for the compiled graph that the view will record next.
void report_lacking(const dermis_view_t& view, const ViewTables& tables, Diagnostics& diagnostics) {
  const ViewTables::Described &running = tables.compiled_graphs[0],
                              &next = tables.compiled_graphs[1],
                              &newest = next.compiled_graph ? next : running;
  if (!newest.compiled_graph) return;
  std::vector<const Plan*> plans;
  for (const RunnablePlan& plan : newest.compiled_graph->plans)
    plans.push_back(&plan.compiled->plan);
  report_missing_rows(newest.compiled_graph->graph, view.context->pass_types, plans, tables.errors,
                      tables.costs, newest.configurations, diagnostics);
}

void take_over(dermis_view_t& view, ViewTables& tables) noexcept {
  std::swap(view.chooser.errors, tables.errors);
  std::swap(view.chooser.error_correction, tables.error_correction);
  view.chooser.run = view.chooser.previous_run = {}; // its technique is of the old table
  std::swap(view.chooser.calibration, tables.calibration);
  std::swap(view.chooser.costs, tables.costs);
  for (auto& [compiled_graph, configurations] : tables.compiled_graphs)
    if (compiled_graph) {
      compiled_graph->configurations.swap(configurations);
      ++compiled_graph->revision;
    }
  retire_other_costs(view.chooser, newest(view));
}

// Returns DERMIS_OK if all values are in range. The comparisons also reject NaN.
dermis_result check_budget(const Log& log, const dermis_budget& budget) {
  constexpr const char* function = "dermis_graph_set_budget";
  if (!(budget.milliseconds >= 0 && budget.milliseconds <= largest_budget_ms))
    return bad_argument(log, "{}: milliseconds is {}, expected 0..{}", function,
                        budget.milliseconds, largest_budget_ms);
  if ((budget.flags & ~known_flags) != 0)
    return bad_argument(log, "{}: flags is {:#x}, known is {:#x}", function, budget.flags,
                        known_flags);
  if ((budget.flags & DERMIS_BUDGET_TRIALS_AT_CUTS) != 0 &&
      (budget.flags & DERMIS_BUDGET_NO_TRIALS) != 0)
    return bad_argument(log,
                        "{}: flags has DERMIS_BUDGET_TRIALS_AT_CUTS and DERMIS_BUDGET_NO_TRIALS, "
                        "expected at most one of them",
                        function);
  if (budget.percentile != 0 &&
      !(budget.percentile >= min_percentile && budget.percentile <= max_percentile))
    return bad_argument(log, "{}: percentile is {}, expected {}..{}, or 0 for 0.95", function,
                        budget.percentile, min_percentile, max_percentile);
  if (budget.uncertainty != 0 &&
      !(budget.uncertainty >= 1 && budget.uncertainty <= max_uncertainty))
    return bad_argument(log, "{}: uncertainty is {}, expected 1..{}, or 0 for the calibration's",
                        function, budget.uncertainty, max_uncertainty);
  return DERMIS_OK;
}

Budget budget_of(const dermis_budget& given) {
  Budget budget;
  budget.ms = static_cast<double>(given.milliseconds);
  budget.deterministic = (given.flags & DERMIS_BUDGET_DETERMINISTIC) != 0;
  budget.all_views = (given.flags & DERMIS_BUDGET_ALL_VIEWS) != 0;
  if (given.percentile != 0) budget.percentile = static_cast<double>(given.percentile);
  if ((given.flags & DERMIS_BUDGET_TRIALS_AT_CUTS) != 0) budget.trials = choice::Trials::cuts_only;
  if ((given.flags & DERMIS_BUDGET_NO_TRIALS) != 0) budget.trials = choice::Trials::off;
  return budget;
}

dermis_result set_budget(dermis_graph_t& graph, const dermis_budget* given, dermis_report* report) {
  const Log& log = graph.context->log;
  dermis_budget budget = DERMIS_BUDGET_INIT;
  if (const SizedRead read = read_sized(given, budget); read != SizedRead::ok)
    return rejected_size(log, read, "dermis_graph_set_budget: budget", stated_size(given),
                         sizeof(dermis_budget));
  if (const dermis_result result = check_budget(log, budget); result != DERMIS_OK) return result;
  Diagnostics diagnostics;
  Tables tables;
  if (const dermis_result result = read_tables(log, budget, tables, diagnostics);
      result != DERMIS_OK)
    return result;
  if (diagnostics.has_errors())
    return conclude(log, DERMIS_ERROR_CONFIG, std::move(diagnostics), report);

  const std::lock_guard changing(graph.changing);
  const bool rebuild_tables = tables.errors || tables.calibration;
  std::vector<ViewTables> views;
  for_each_view(graph, [&](dermis_view_t& view) {
    const std::lock_guard lock(view.mutex);
    if (rebuild_tables) views.push_back(tables_of(view, tables));
  });
  if (rebuild_tables) report_lacking(graph.own, views.front(), diagnostics);
  if (const dermis_result result = conclude(log, DERMIS_OK, std::move(diagnostics), report);
      result != DERMIS_OK)
    return result;
  size_t v = 0; // nothing fails from here on
  for_each_view(graph, [&](dermis_view_t& view) {
    const std::lock_guard lock(view.mutex);
    Chooser& chooser = view.chooser;
    if (rebuild_tables) take_over(view, views[v++]);
    // Decisions restart, also if the last frame is discarded.
    if (tables.calibration) chooser.decided_for = chooser.previously_decided_for = 0;
    chooser.budget = budget_of(budget);
    if (budget.uncertainty != 0)
      chooser.costs.set_uncertainty(double(budget.uncertainty), true);
    else
      chooser.costs.set_uncertainty(chooser.calibration.uncertainty);
  });
  return DERMIS_OK;
}

uint32_t skips_of(const FrameChoice& frame, const CompiledGraph& compiled_graph) {
  const subsurface::FrameCounters& seen = frame.counters;
  if (compiled_graph.without_material) return DERMIS_SKIP_NO_MATERIAL;
  if (frame.left_out) return DERMIS_SKIP_NO_BOUNDS;
  uint32_t skips = 0;
  if (compiled_graph.plans[frame.plan].counts_tiles &&
      seen.scattering_tiles + seen.copied_tiles + seen.uniform_tiles == 0)
    skips |= DERMIS_SKIP_NOTHING_SEEN;
  if (seen.copied_tiles > 0) skips |= DERMIS_SKIP_SUBPIXEL;
  if (seen.uniform_tiles > 0) skips |= DERMIS_SKIP_UNIFORM_LIGHT;
  if (frame.history_unread) skips |= DERMIS_SKIP_HISTORY;
  return skips;
}

// Returns why a frame took longer than its budget and its prediction.
const char* miss_of(const FrameChoice& frame, bool counts_tiles) {
  constexpr double tolerance = 1.15; // times the budget, as in dermis bench budget
  constexpr double changed_by = 0.1; // fraction of the tiles
  if (!frame.timed || frame.budget_ms <= 0 || frame.measured_ms <= tolerance * frame.budget_ms)
    return "";
  if (frame.decision.why == choice::ReasonKind::nothing_fits)
    return "no configuration fits the budget";
  const double expected = static_cast<double>(frame.expected_tiles);
  const double seen =
      static_cast<double>(uint64_t{frame.counters.scattering_tiles} + frame.counters.copied_tiles +
                          frame.counters.uniform_tiles);
  return counts_tiles && std::abs(seen - expected) > changed_by * std::max(expected, 1.0)
             ? "the number of tiles changed"
             : "passes took longer than their learned times";
}

dermis_frame_report make_report(const Chooser& chooser, const CompiledGraph& compiled_graph) {
  const FrameChoice& frame = chooser.newest;
  dermis_frame_report out = DERMIS_FRAME_REPORT_INIT;
  out.frame_index = frame.frame_index;
  out.configuration = compiled_graph.configurations[frame.configuration].name.c_str();
  out.reason = choice::why_text(frame.decision);
  out.miss = miss_of(frame, compiled_graph.plans[frame.plan].counts_tiles);
  out.budget_ms = static_cast<float>(frame.budget_ms);
  out.predicted_ms = static_cast<float>(frame.decision.expected_ms);
  out.measured_ms = frame.timed ? static_cast<float>(frame.measured_ms) : -1.0f;
  out.predicted_rmse = static_cast<float>(frame.decision.rmse);
  out.skips = skips_of(frame, compiled_graph);
  return out;
}

dermis_frame_statistics make_statistics(const Chooser& chooser,
                                        const CompiledGraph& compiled_graph) {
  const FrameChoice& frame = chooser.newest;
  const choice::Configuration& configuration = compiled_graph.configurations[frame.configuration];
  const bool better = frame.decision.next_better < compiled_graph.configurations.size();
  dermis_frame_statistics out = DERMIS_FRAME_STATISTICS_INIT;
  out.frame_index = frame.frame_index;
  out.technique =
      configuration.technique < 0
          ? ""
          : chooser.errors.techniques[static_cast<size_t>(configuration.technique)].name.c_str();
  out.next_better =
      better ? compiled_graph.configurations[frame.decision.next_better].name.c_str() : "";
  out.next_better_missing_ms = static_cast<float>(frame.decision.missing_ms);
  out.predicted_margin_ms =
      static_cast<float>(frame.decision.bound_ms - frame.decision.expected_ms);
  out.calibrated_ms = static_cast<float>(frame.calibrated_ms);
  out.configuration_count = static_cast<uint32_t>(compiled_graph.configurations.size());
  out.switches = frame.switches;
  out.dispatches = frame.dispatches;
  out.groups = frame.groups;
  out.view_tiles = static_cast<uint32_t>(tiles_of(frame.rectangle));
  out.scattering_tiles = frame.counters.scattering_tiles;
  out.copied_tiles = frame.counters.copied_tiles;
  out.uniform_tiles = frame.counters.uniform_tiles;
  std::copy(frame.counters.sampled_tiles.begin(), frame.counters.sampled_tiles.end(),
            out.sampled_tiles);
  out.sample_units = frame.counters.sample_units;
  out.sample_demand = frame.counters.sample_demand;
  out.mean_d_px = static_cast<float>(subsurface::mean_d_px(frame.counters));
  out.mean_relief = static_cast<float>(subsurface::mean_relief(frame.counters));
  const subsurface::ProbedError probed = subsurface::probed_error(frame.counters);
  out.probed_tiles = probed.tiles;
  out.probed_rmse = static_cast<float>(probed.rmse);
  out.probed_rmse_low = static_cast<float>(probed.low);
  out.probed_rmse_high = static_cast<float>(probed.high);
  out.transmitted_rms = static_cast<float>(subsurface::transmitted_rms(frame.counters));
  return out;
}

// Writes make(chooser, compiled_graph) of the newest frame whose counters are available to *out.
template <class T, class Make>
dermis_result write_newest(dermis_view_t& view, const char* function, const char* name,
                           uint64_t completed, T* out, Make make) {
  const Log& log = view.context->log;
  if (out == nullptr) return bad_argument(log, "{}: {} is NULL", function, name);
  const size_t size = stated_size(out);
  if (const SizedRead read = check_size<T>(size); read != SizedRead::ok)
    return rejected_size(log, read, function, name, size, sizeof(T));
  const std::lock_guard lock(view.mutex);
  if (!view.running) return DERMIS_NOT_READY;
  observe(view.chooser, *view.running, std::min(completed, view.last_frame));
  if (const dermis_result loss = check_loss(view, function); loss != DERMIS_OK) return loss;
  if (view.chooser.newest.frame_index == 0 ||
      view.chooser.newest.compiled_graph != view.running->serial)
    return DERMIS_NOT_READY;
  write_sized(out, size, make(view.chooser, *view.running));
  return DERMIS_OK;
}

} // namespace

dermis_result get_report(dermis_view_t& view, uint64_t completed, dermis_frame_report* out) {
  return write_newest(view, "dermis_view_report", "report", completed, out, make_report);
}

dermis_result get_statistics(dermis_view_t& view, uint64_t completed,
                             dermis_frame_statistics* out) {
  return write_newest(view, "dermis_view_statistics", "statistics", completed, out,
                      make_statistics);
}

} // namespace dermis::abi

using namespace dermis::abi;

extern "C" dermis_result DERMIS_CALL dermis_graph_set_budget(dermis_graph graph,
                                                             const dermis_budget* budget,
                                                             dermis_report* report) {
  if (report != nullptr) *report = nullptr;
  if (graph == nullptr) return bad_argument({}, "dermis_graph_set_budget: graph is NULL");
  const Log& log = graph->context->log;
  return guarded(log, "dermis_graph_set_budget", [&] {
    if (const dermis_result alive = check_alive(*graph->context, "dermis_graph_set_budget");
        alive != DERMIS_OK)
      return alive;
    if (budget == nullptr) return bad_argument(log, "dermis_graph_set_budget: budget is NULL");
    return set_budget(*graph, budget, report);
  });
}

extern "C" dermis_result DERMIS_CALL dermis_graph_calibration(dermis_graph graph, size_t* size,
                                                              char* text) {
  if (graph == nullptr) return bad_argument({}, "dermis_graph_calibration: graph is NULL");
  const Log& log = graph->context->log;
  return guarded(log, "dermis_graph_calibration", [&] {
    if (size == nullptr) return bad_argument(log, "dermis_graph_calibration: size is NULL");
    const std::lock_guard lock(graph->own.mutex);
    const dermis::choice::CostEstimator& costs = graph->own.chooser.costs;
    // Costs that were not measured are as uncertain as they were; the others state their own.
    const std::string json = dermis::choice::write_calibration(
        {graph->context->device.properties.deviceName, graph->own.chooser.calibration.uncertainty,
         costs.calibration()});
    const size_t capacity = *size;
    *size = json.size() + 1;
    if (text == nullptr) return DERMIS_OK;
    if (capacity < *size) return DERMIS_INCOMPLETE;
    std::memcpy(text, json.c_str(), *size);
    return DERMIS_OK;
  });
}
