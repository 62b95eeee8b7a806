#pragma once
// Runs the library's controller on a simulated device: estimates, margins and decisions as
// integration/abi/chooser.cpp uses them, without Vulkan.

#include "passes/choice/budget_controller.hpp"
#include "passes/choice/budget_division.hpp"
#include "passes/choice/cost_estimator.hpp"
#include "passes/choice/time_margin.hpp"
#include "tests/passes/choice/simulated_device.hpp"

#include <deque>
#include <optional>
#include <span>
#include <vector>

namespace dermis::choice_test {

struct LoopOptions {
  choice::Trials trials = choice::Trials::on;
  bool deterministic = false; // by the calibration only
  double percentile = 0.95;
};

// A controller for the configurations of a scenario, which must outlive it.
class ControlledGraph {
public:
  ControlledGraph(const Scenario& scenario, const LoopOptions& options);
  // Returns the forecasts of all configurations for a frame, as decide() uses them.
  std::span<const choice::Forecast> expect(std::optional<double> tiles);
  choice::Offers offers(std::optional<double> tiles) {
    return choice::make_offers(expect(tiles), state_);
  }
  // Decides for a frame. `tiles`: last count; nullopt: nothing was counted yet.
  choice::Decision decide(double budget_ms, std::optional<double> tiles, bool cut = false);
  // Learns from a frame that the device has finished.
  void observe(const choice::Decision& decision, const SimulatedFrame& frame, bool first);

private:
  choice::Forecast forecast(uint32_t configuration, double tiles,
                            std::span<const choice::CostFactors> factors) const;

  const Scenario& scenario_;
  LoopOptions options_;
  choice::CostEstimator costs_;
  choice::TimeMargins margins_;
  choice::DecisionState state_;
  std::vector<choice::CostId> ids_; // by pass
  std::vector<choice::Forecast> forecasts_;
  std::vector<choice::Assessment> assessments_;
  std::vector<choice::PassTime> times_;
};

// Frames that are decided but whose times are not known yet.
class Pipeline {
public:
  Pipeline(ControlledGraph& graph, const Scenario& scenario) : graph_(graph), scenario_(scenario) {}
  // Learns from the frame `latency` frames ago, if there is one.
  void finish_oldest();
  // Runs the decision in frame `frame`, and keeps what the device measured.
  const SimulatedFrame& run(SimulatedDevice& device, const choice::Decision& decision, int frame);
  bool first_of_plan() const { return pending_.back().first; }

private:
  struct Pending {
    choice::Decision decision;
    SimulatedFrame frame;
    bool first = false;
  };
  ControlledGraph& graph_;
  const Scenario& scenario_;
  std::deque<Pending> pending_;
  uint32_t last_ = choice::no_configuration;
};

// One frame of a run.
struct RunFrame {
  uint32_t configuration = 0;
  double units = 0, ms = 0, tiles = 0;
};
// Runs the scenario's frames; `frames` 0: all of them.
std::vector<RunFrame> run_scenario(const Scenario& scenario, double budget_ms, uint64_t noise_seed,
                                   const LoopOptions& options = {}, int frames = 0);

} // namespace dermis::choice_test
