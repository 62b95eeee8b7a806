// Returns forecasts to the host: what each configuration would take, and what a budget would
// choose.

#include "integration/abi/graph.hpp"
#include "integration/abi/two_call.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace dermis::abi {
namespace {

// Budgets are filled up to rounding errors.
constexpr double rounding = 1 + 1e-5;

struct Request {
  dermis_view_t* view = nullptr;
  uint32_t width = 0, height = 0; // 0: those of the last frame
  double budget_ms = 0;           // 0: the present one
};

dermis_result read_request(dermis_graph_t& graph, const char* function,
                           const dermis_forecast_desc* given, Request& out) {
  const Log& log = graph.context->log;
  dermis_forecast_desc desc = DERMIS_FORECAST_DESC_INIT;
  if (given != nullptr)
    if (const SizedRead read = read_sized(given, desc); read != SizedRead::ok)
      return rejected_size(log, read, function, "desc", stated_size(given),
                           sizeof(dermis_forecast_desc));
  if (desc.view != nullptr && desc.view->graph != &graph)
    return bad_argument(log, "{}: desc.view belongs to another graph", function);
  if ((desc.width == 0) != (desc.height == 0))
    return bad_argument(log, "{}: desc.width is {} and desc.height is {}, expected both or neither",
                        function, desc.width, desc.height);
  if (!(desc.milliseconds >= 0 && desc.milliseconds <= largest_budget_ms))
    return bad_argument(log, "{}: desc.milliseconds is {}, expected 0..{}", function,
                        desc.milliseconds, largest_budget_ms);
  out.view = desc.view != nullptr ? desc.view : &graph.own;
  out.width = desc.width;
  out.height = desc.height;
  out.budget_ms = double(desc.milliseconds);
  return DERMIS_OK;
}

// Forecasts of a view, whose mutex is locked.
struct Forecasts {
  const CompiledGraph* compiled_graph = nullptr;
  std::span<const choice::Forecast> all; // by configuration
  double budget_ms = 0;
};

dermis_result make_forecasts(const char* function, const Request& request, Forecasts& out) {
  dermis_view_t& view = *request.view;
  CompiledGraph& compiled_graph = newest(view);
  const Plan& plan = compiled_graph.current().compiled->plan;
  vulkan::Rectangle rectangle{0, 0, request.width, request.height};
  if (request.width > plan.view_width || request.height > plan.view_height)
    return bad_argument(view.context->log,
                        "{}: the rectangle is {}x{}, larger than the allocated size {}x{}",
                        function, request.width, request.height, plan.view_width, plan.view_height);
  if (request.width == 0) {
    rectangle = view.chooser.newest.rectangle;
    if (rectangle.width == 0) rectangle = {0, 0, plan.view_width, plan.view_height};
    rectangle.width = std::min(rectangle.width, plan.view_width);
    rectangle.height = std::min(rectangle.height, plan.view_height);
  }
  out.compiled_graph = &compiled_graph;
  out.all = forecast(view.chooser, compiled_graph, rectangle);
  out.budget_ms = request.budget_ms > 0 ? request.budget_ms : budget_of_view(view);
  return DERMIS_OK;
}

// Returns the samples that fit; without a budget, those requested.
double units_within(const choice::Forecast& forecast, double budget_ms) {
  if (!forecast.takes_samples) return 0;
  if (budget_ms <= 0 || forecast.time.unit_ms <= 0) return forecast.demand;
  const double left_ms = budget_ms * std::exp(-forecast.margin) - forecast.time.pessimistic_ms;
  return std::clamp(left_ms / forecast.time.unit_ms, 0.0, forecast.demand);
}

dermis_outcome outcome_of(const Forecasts& forecasts, uint32_t configuration, double units) {
  const choice::Forecast& forecast = forecasts.all[configuration];
  const CompiledGraph& compiled_graph = *forecasts.compiled_graph;
  const double samples_ms = units * forecast.time.unit_ms;
  const double bound_ms = (forecast.time.pessimistic_ms + samples_ms) * std::exp(forecast.margin);
  const bool fits = forecasts.budget_ms <= 0 || bound_ms <= rounding * forecasts.budget_ms;
  dermis_outcome out = DERMIS_OUTCOME_INIT;
  out.configuration = compiled_graph.configurations[configuration].name.c_str();
  out.expected_ms = static_cast<float>(forecast.time.expected_ms + samples_ms);
  out.percentile_ms = static_cast<float>(bound_ms);
  out.expected_rmse = static_cast<float>(rmse_with(forecast, units));
  out.fits = fits ? 1 : 0;
  const PlanBytes bytes =
      bytes_of_plan(compiled_graph, compiled_graph.configurations[configuration].plan);
  out.transient_bytes = bytes.transient;
  out.history_bytes = bytes.history;
  return out;
}

// Returns whether `other` takes no more time and has no more error. Of two equal ones the first is
// not dominated.
bool dominates(const dermis_outcome& other, const dermis_outcome& one, bool other_is_first) {
  if (other.expected_ms > one.expected_ms || other.expected_rmse > one.expected_rmse) return false;
  return other_is_first || other.expected_ms < one.expected_ms ||
         other.expected_rmse < one.expected_rmse;
}

// Calls `use(request, forecasts)` with the forecasts of the requested view, whose mutex is locked.
template <class Use>
dermis_result with_forecasts(dermis_graph_t& graph, const char* function,
                             const dermis_forecast_desc* desc, Use use) {
  Request request;
  if (const dermis_result result = read_request(graph, function, desc, request);
      result != DERMIS_OK)
    return result;
  const std::lock_guard lock(request.view->mutex);
  Forecasts forecasts;
  if (const dermis_result result = make_forecasts(function, request, forecasts);
      result != DERMIS_OK)
    return result;
  return use(request, forecasts);
}

dermis_result get_frontier(dermis_graph_t& graph, const dermis_forecast_desc* desc, uint32_t* count,
                           dermis_outcome* outcomes) {
  constexpr const char* function = "dermis_graph_frontier";
  return with_forecasts(graph, function, desc, [&](const Request&, const Forecasts& forecasts) {
    std::array<dermis_outcome, choice::max_configurations> all;
    const size_t number = forecasts.all.size();
    for (uint32_t i = 0; i < number; ++i)
      all[i] = outcome_of(forecasts, i, units_within(forecasts.all[i], forecasts.budget_ms));
    for (size_t i = 0; i < number; ++i)
      for (size_t k = 0; k < number && all[i].dominated == 0; ++k)
        all[i].dominated = k != i && dominates(all[k], all[i], k < i) ? 1 : 0;
    std::sort(all.begin(), all.begin() + static_cast<ptrdiff_t>(number),
              [](const dermis_outcome& a, const dermis_outcome& b) {
                return a.expected_ms != b.expected_ms ? a.expected_ms < b.expected_ms
                                                      : a.expected_rmse < b.expected_rmse;
              });
    return fill_array(graph.context->log, function, count, outcomes, static_cast<uint32_t>(number),
                      [&](uint32_t i) { return all[i]; });
  });
}

dermis_result predict(dermis_graph_t& graph, const dermis_forecast_desc* desc,
                      dermis_outcome* outcome) {
  constexpr const char* function = "dermis_graph_predict";
  const Log& log = graph.context->log;
  if (outcome == nullptr) return bad_argument(log, "{}: outcome is NULL", function);
  const size_t size = stated_size(outcome);
  if (const SizedRead read = check_size<dermis_outcome>(size); read != SizedRead::ok)
    return rejected_size(log, read, function, "outcome", size, sizeof(dermis_outcome));
  return with_forecasts(
      graph, function, desc, [&](const Request& request, const Forecasts& forecasts) {
        const choice::Decision decision = settled_decision(
            request.view->chooser, *forecasts.compiled_graph, forecasts.all, forecasts.budget_ms);
        write_sized(outcome, size, outcome_of(forecasts, decision.configuration, decision.units));
        return DERMIS_OK;
      });
}

} // namespace
} // namespace dermis::abi

using namespace dermis::abi;

extern "C" dermis_result DERMIS_CALL dermis_graph_frontier(dermis_graph graph,
                                                           const dermis_forecast_desc* desc,
                                                           uint32_t* count,
                                                           dermis_outcome* outcomes) {
  if (graph == nullptr) return bad_argument({}, "dermis_graph_frontier: graph is NULL");
  return guarded(graph->context->log, "dermis_graph_frontier",
                 [&] { return get_frontier(*graph, desc, count, outcomes); });
}

extern "C" dermis_result DERMIS_CALL dermis_graph_predict(dermis_graph graph,
                                                          const dermis_forecast_desc* desc,
                                                          dermis_outcome* outcome) {
  if (graph == nullptr) return bad_argument({}, "dermis_graph_predict: graph is NULL");
  return guarded(graph->context->log, "dermis_graph_predict",
                 [&] { return predict(*graph, desc, outcome); });
}
