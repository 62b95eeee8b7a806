// Two control loops in one frame: a host that scales its resolution to hold a frame time, and the
// controller inside its budget. The budget is a fixed fraction of the frame, never what is left.

#include "tests/passes/choice/judge.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace dermis::choice_test {
namespace {

enum class BudgetRule : uint8_t { fixed_fraction, what_is_left };

// A host whose other passes cost as much as the resolution has pixels, and vary slowly.
class Host {
public:
  Host(double frame_ms, uint64_t seed)
      : frame_ms_(frame_ms), total_ms_(frame_ms), others_ms_(0.8 * frame_ms), random_(seed) {}

  // Returns the fraction of pixels that the next frame renders.
  double next_pixels() {
    constexpr double aim = 0.97, gain = 0.08, min_pixels = 0.3;
    pixels_ *= std::pow(aim * frame_ms_ / total_ms_, gain);
    return pixels_ = std::clamp(pixels_, min_pixels, 1.0);
  }
  double left_ms() const { return std::max(0.05 * frame_ms_, frame_ms_ - others_ms_); }
  double others_at(int frame) {
    const double wave =
        frame > 2700 ? 1 : 1 + 0.15 * std::sin(2 * std::numbers::pi * frame / 600.0);
    return 0.95 * frame_ms_ * pixels_ * wave * std::exp(random_.normal(0.02));
  }
  void measure(double ours_ms, double others_ms) {
    constexpr double memory = 0.7;
    total_ms_ = memory * total_ms_ + (1 - memory) * (ours_ms + others_ms);
    others_ms_ = memory * others_ms_ + (1 - memory) * others_ms;
  }

private:
  double frame_ms_, total_ms_, others_ms_, pixels_ = 0.8;
  Random random_;
};

struct Outcome {
  double switches_per_minute = 0, excess_error = 0, pixels = 0, late = 0;
};

Outcome run_loops(uint64_t seed, BudgetRule rule) {
  constexpr int first_counted = 600, first_calm = 3600; // frames
  Scenario scenario = make_scenario(Disturbance::none, seed);
  const double view_tiles = scenario.view_tiles, tiles = scenario.tiles;
  const double fraction_ms = scenario.budgets_ms[1], frame_ms = fraction_ms / 0.2;
  ControlledGraph graph(scenario, {});
  SimulatedDevice device(scenario, seed + 7);
  Pipeline pipeline(graph, scenario);
  Host host(frame_ms, seed + 99);
  std::deque<std::pair<double, double>> times; // ours and others, not known to the host yet
  std::vector<double> pixels_of;
  Outcome out;
  uint32_t last = choice::no_configuration;
  for (int t = 0; t < scenario_frames; ++t) {
    pipeline.finish_oldest();
    if (static_cast<int>(times.size()) >= scenario.latency) {
      host.measure(times.front().first, times.front().second);
      times.pop_front();
    }
    const double pixels = host.next_pixels();
    pixels_of.push_back(pixels);
    scenario.view_tiles = std::floor(view_tiles * pixels);
    scenario.tiles_at[static_cast<size_t>(t)] = std::floor(tiles * pixels);
    std::optional<double> counted; // scaled to the pixels of this frame
    if (const auto then = static_cast<size_t>(std::max(t - scenario.latency, 0));
        t >= scenario.latency)
      counted = scenario.tiles_at[then] * pixels / pixels_of[then];
    const double budget_ms = rule == BudgetRule::fixed_fraction ? fraction_ms : host.left_ms();
    choice::Decision decision = graph.decide(budget_ms, counted);
    const double now_tiles = scenario.tiles_at[static_cast<size_t>(t)];
    decision.units = std::min(std::floor(decision.units), requested_units(now_tiles));
    const double ours_ms = pipeline.run(device, decision, t).total_ms;
    const double others_ms = host.others_at(t);
    times.emplace_back(ours_ms, others_ms);
    if (t > first_counted) {
      out.switches_per_minute +=
          decision.configuration != last ? 3600.0 / (scenario_frames - first_counted) : 0;
      out.late += ours_ms + others_ms > frame_ms ? 1.0 / (scenario_frames - first_counted) : 0;
    }
    last = decision.configuration;
    if (t < first_calm) continue;
    out.pixels += pixels / (scenario_frames - first_calm);
    out.excess_error +=
        (rmse_of(scenario.configurations[decision.configuration], decision.units, now_tiles) /
             best_choice(scenario, fraction_ms, now_tiles, t).rmse -
         1) /
        (scenario_frames - first_calm);
  }
  return out;
}

Outcome mean_of(BudgetRule rule) {
  constexpr int scenarios = 16;
  Outcome mean;
  for (int i = 0; i < scenarios; ++i) {
    const Outcome one = run_loops(2 * static_cast<uint64_t>(i), rule); // fair calibrations
    mean.switches_per_minute += one.switches_per_minute / scenarios;
    mean.excess_error += one.excess_error / scenarios;
    mean.pixels += one.pixels / scenarios;
    mean.late += one.late / scenarios;
  }
  std::printf("%s: %.2f switches a minute, pixels %.3f, late %.3f, error +%.0f %%\n",
              rule == BudgetRule::fixed_fraction ? "fixed fraction" : "what is left",
              mean.switches_per_minute, mean.pixels, mean.late, 100 * mean.excess_error);
  return mean;
}

TEST(TwoLoops, FixedFraction_IsCalmAndAccurate) {
  const Outcome fixed = mean_of(BudgetRule::fixed_fraction);
  EXPECT_LT(fixed.switches_per_minute, 1.5);
  EXPECT_LT(fixed.excess_error, 0.25);
}

// The resolution takes what the controller leaves, so the technique starves.
TEST(TwoLoops, WhatIsLeft_StarvesTheTechnique) {
  const Outcome fixed = mean_of(BudgetRule::fixed_fraction);
  const Outcome left = mean_of(BudgetRule::what_is_left);
  EXPECT_GT(1 + left.excess_error, 1.5 * (1 + fixed.excess_error));
  EXPECT_GT(left.switches_per_minute, fixed.switches_per_minute);
}

} // namespace
} // namespace dermis::choice_test
