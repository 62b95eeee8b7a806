#include "tests/passes/choice/control_loop.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::choice_test {
namespace {

std::string work_of(size_t pass) {
  return "pass" + std::to_string(pass);
}

std::vector<choice::Cost> calibration_of(const Scenario& scenario) {
  std::vector<choice::Cost> costs;
  for (const SimulatedPass& pass : scenario.passes)
    costs.push_back({work_of(costs.size()), pass.calibrated_base_ms * 1e3,
                     pass.calibrated_group_ms * 1e3, 0.1});
  return costs;
}

} // namespace

ControlledGraph::ControlledGraph(const Scenario& scenario, const LoopOptions& options)
    : scenario_(scenario), options_(options), costs_(calibration_of(scenario)) {
  for (size_t p = 0; p < scenario.passes.size(); ++p)
    ids_.push_back(costs_.add(work_of(p)));
  const size_t configurations = scenario.configurations.size();
  forecasts_.resize(configurations);
  assessments_.resize(configurations);
  margins_.restart(configurations, choice::first_margin);
  times_.reserve(scenario.passes.size());
  restart(state_, configurations, costs_.unmeasured());
}

choice::Forecast ControlledGraph::forecast(uint32_t configuration, double tiles,
                                           std::span<const choice::CostFactors> factors) const {
  const SimulatedConfiguration& one = scenario_.configurations[configuration];
  choice::Forecast out;
  out.margin = options_.deterministic ? choice::calibrated_margin : margins_.margin(configuration);
  out.rmse = one.rmse;
  out.unsampled_rmse = one.unsampled_rmse;
  out.time.measured = !options_.deterministic;
  const auto factor_of = [&](uint32_t pass) {
    return options_.deterministic ? choice::CostFactors{} : factors[ids_[pass].value];
  };
  for (const uint32_t pass : one.passes) {
    const double ms =
        costs_.calibrated_cost(ids_[pass]).ms(std::floor(groups_of(scenario_, pass, tiles)));
    const choice::CostFactors factor = factor_of(pass);
    out.time.calibrated_ms += ms;
    out.time.expected_ms += factor.expected * ms;
    out.time.pessimistic_ms += factor.pessimistic * ms;
    out.time.optimistic_ms += factor.optimistic * ms;
    out.time.undisturbed_ms += factor.undisturbed * ms;
    out.time.usual_ms += factor.usual * ms;
    out.time.measured = out.time.measured && factor.measured;
  }
  if (one.samples < 0) return out;
  const auto samples = static_cast<uint32_t>(one.samples);
  const double unit_ms = costs_.calibrated_cost(ids_[samples]).group_ms;
  out.takes_samples = true;
  out.demand = requested_units(tiles);
  out.time.unit_ms = factor_of(samples).expected * unit_ms;
  out.time.undisturbed_unit_ms = factor_of(samples).undisturbed * unit_ms;
  return out;
}

std::span<const choice::Forecast> ControlledGraph::expect(std::optional<double> tiles) {
  const double expected_tiles = tiles.value_or(scenario_.view_tiles);
  const std::span<const choice::CostFactors> factors = costs_.predict(state_.clock_s);
  for (uint32_t i = 0; i < forecasts_.size(); ++i)
    forecasts_[i] = forecast(i, expected_tiles, factors);
  return forecasts_;
}

choice::Decision ControlledGraph::decide(double budget_ms, std::optional<double> tiles, bool cut) {
  expect(tiles);
  const choice::FrameInput frame{budget_ms, frame_seconds, cut, !tiles.has_value(),
                                 options_.trials};
  return choice::decide(forecasts_, frame, state_, assessments_);
}

void ControlledGraph::observe(const choice::Decision& decision, const SimulatedFrame& frame,
                              bool first) {
  if (decision.rejected != choice::no_configuration) {
    const SimulatedConfiguration& rejected = scenario_.configurations[decision.rejected];
    for (const uint32_t pass : rejected.passes)
      costs_.reduce_optimism(ids_[pass]);
    if (rejected.samples >= 0) costs_.reduce_optimism(ids_[static_cast<size_t>(rejected.samples)]);
  }
  if (!frame.timed || first || options_.deterministic) return;
  times_.clear();
  double measured_ms = 0;
  for (uint32_t p = 0; p < ids_.size(); ++p)
    if (frame.ms[p] >= 0) {
      times_.push_back({ids_[p], static_cast<uint64_t>(frame.groups[p]), frame.ms[p]});
      measured_ms += frame.ms[p];
    }
  costs_.observe(times_, state_.clock_s);
  if (decision.measured && !costs_.device_stepped())
    margins_.observe(decision.configuration, decision.expected_ms, measured_ms,
                     options_.percentile);
}

void Pipeline::finish_oldest() {
  if (static_cast<int>(pending_.size()) < scenario_.latency) return;
  const Pending& oldest = pending_.front();
  graph_.observe(oldest.decision, oldest.frame, oldest.first);
  pending_.pop_front();
}

const SimulatedFrame& Pipeline::run(SimulatedDevice& device, const choice::Decision& decision,
                                    int frame) {
  Pending& one = pending_.emplace_back();
  one.decision = decision;
  one.first = decision.configuration != last_;
  last_ = decision.configuration;
  device.run(decision.configuration, decision.units, frame, one.first, one.frame);
  return one.frame;
}

std::vector<RunFrame> run_scenario(const Scenario& scenario, double budget_ms, uint64_t noise_seed,
                                   const LoopOptions& options, int frames) {
  ControlledGraph graph(scenario, options);
  SimulatedDevice device(scenario, noise_seed);
  Pipeline pipeline(graph, scenario);
  std::vector<RunFrame> run;
  const int count = frames > 0 ? frames : static_cast<int>(scenario.clock.size());
  for (int t = 0; t < count; ++t) {
    pipeline.finish_oldest();
    const double tiles = scenario.tiles_at[static_cast<size_t>(t)];
    std::optional<double> counted;
    if (t >= scenario.latency)
      counted = scenario.tiles_at[static_cast<size_t>(t - scenario.latency)];
    const bool cut = scenario.disturbance == Disturbance::cut &&
                     (t == first_disturbed || t == scenario.disturbed_until);
    choice::Decision decision = graph.decide(budget_ms, counted, cut);
    // tiles take no more than they request in the frame itself
    decision.units = std::min(std::floor(decision.units), requested_units(tiles));
    const SimulatedFrame& frame = pipeline.run(device, decision, t);
    run.push_back({decision.configuration, decision.units, frame.total_ms, tiles});
  }
  return run;
}

} // namespace dermis::choice_test
