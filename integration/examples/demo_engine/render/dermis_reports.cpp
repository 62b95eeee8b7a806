// Reads what Dermis reports about recorded frames: times, choice, forecasts, histories and costs.

#include "integration/examples/demo_engine/dermis_calls.hpp"
#include "integration/examples/demo_engine/render/dermis_host.hpp"
#include "integration/examples/demo_engine/render/reported_frame.hpp"

#include <algorithm>

namespace demo {

std::vector<PassTime> graph_times(DermisHost& host, uint64_t frame_index) {
  uint32_t count = 0;
  if (dermis_view_timings(dermis_graph_view(graph_of(host)), frame_index, &count, nullptr) !=
          DERMIS_OK ||
      count == 0)
    return {};
  std::vector<dermis_pass_timing> timings(count, dermis_pass_timing DERMIS_PASS_TIMING_INIT);
  if (dermis_view_timings(dermis_graph_view(graph_of(host)), frame_index, &count, timings.data()) !=
      DERMIS_OK)
    return {};
  std::vector<PassTime> times;
  for (const dermis_pass_timing& one : timings)
    times.push_back({one.pass, static_cast<double>(one.nanoseconds) * 1e-6});
  return times;
}

Result<std::vector<FrameOutcome>> graph_frontier(DermisHost& host) {
  uint32_t count = 0;
  dermis_result result = dermis_graph_frontier(graph_of(host), nullptr, &count, nullptr);
  std::vector<dermis_outcome> outcomes(count, dermis_outcome DERMIS_OUTCOME_INIT);
  if (result == DERMIS_OK)
    result = dermis_graph_frontier(graph_of(host), nullptr, &count, outcomes.data());
  if (result != DERMIS_OK) return dermis_error("dermis_graph_frontier", result);
  std::vector<FrameOutcome> out;
  for (const dermis_outcome& one : outcomes)
    out.push_back({one.configuration, double(one.expected_ms), double(one.percentile_ms),
                   double(one.expected_rmse), one.fits != 0, one.dominated != 0,
                   one.transient_bytes, one.history_bytes});
  return out;
}

Result<FrameChoice> graph_choice(DermisHost& host, uint64_t frame_index) {
  ReportedFrame choice;
  const dermis_result result =
      read_reported(dermis_graph_view(graph_of(host)), frame_index, choice);
  if (result != DERMIS_OK) return dermis_error("dermis_view_report", result);
  FrameChoice out;
  out.configuration = choice.configuration;
  out.technique = choice.technique;
  out.why = choice.reason;
  out.next_better = choice.next_better;
  out.budget_ms = choice.budget_ms;
  out.predicted_ms = choice.predicted_ms;
  out.predicted_margin_ms = choice.predicted_margin_ms;
  out.measured_ms = choice.measured_ms;
  out.calibrated_ms = choice.calibrated_ms;
  out.predicted_rmse = choice.predicted_rmse;
  out.next_better_missing_ms = choice.next_better_missing_ms;
  out.mean_d_px = choice.mean_d_px;
  out.mean_relief = choice.mean_relief;
  out.configurations = choice.configuration_count;
  out.view_tiles = choice.view_tiles;
  out.scattering_tiles = choice.scattering_tiles;
  out.copied_tiles = choice.copied_tiles;
  out.switches = choice.switches;
  out.uniform_tiles = choice.uniform_tiles;
  out.dispatches = choice.dispatches;
  out.groups = choice.groups;
  std::copy(std::begin(choice.sampled_tiles), std::end(choice.sampled_tiles),
            out.sampled_tiles.begin());
  out.sample_units = choice.sample_units;
  out.sample_demand = choice.sample_demand;
  out.probed_tiles = choice.probed_tiles;
  out.probed_rmse = static_cast<double>(choice.probed_rmse);
  out.probed_rmse_low = static_cast<double>(choice.probed_rmse_low);
  out.probed_rmse_high = static_cast<double>(choice.probed_rmse_high);
  out.transmitted_rms = static_cast<double>(choice.transmitted_rms);
  out.miss = choice.miss;
  return out;
}

Result<std::vector<FrameHistory>> graph_histories(DermisHost& host) {
  uint32_t count = 0;
  dermis_result result = dermis_view_histories(dermis_graph_view(graph_of(host)), &count, nullptr);
  if (result != DERMIS_OK) return dermis_error("dermis_view_histories", result);
  std::vector<FrameHistory> out;
  if (count == 0) return out;
  std::vector<dermis_history> all(count, dermis_history DERMIS_HISTORY_INIT);
  result = dermis_view_histories(dermis_graph_view(graph_of(host)), &count, all.data());
  if (result != DERMIS_OK) return dermis_error("dermis_view_histories", result);
  for (const dermis_history& one : all)
    out.push_back({one.name, one.valid != 0, one.age, one.text});
  return out;
}

std::string graph_calibration(DermisHost& host) {
  size_t size = 0;
  if (dermis_graph_calibration(graph_of(host), &size, nullptr) != DERMIS_OK || size == 0) return "";
  std::string text(size, '\0');
  if (dermis_graph_calibration(graph_of(host), &size, text.data()) != DERMIS_OK) return "";
  text.resize(size - 1); // without the final 0
  return text;
}

} // namespace demo
