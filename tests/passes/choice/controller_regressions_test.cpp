// Fixed cases in which an earlier controller chose a worse technique for ever, or no samples.

#include "tests/passes/choice/control_loop.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace dermis::choice_test {
namespace {

constexpr double tiles = 1000, budget_ms = 2.5;
using Factor = std::function<double(int frame)>;

double one(int) {
  return 1;
}

Factor between(int from, int until, double factor) {
  return [=](int t) { return t >= from && t < until ? factor : 1.0; };
}

// Milliseconds of classify, of the better technique, of the other one, and of samples for 1000
// units (0: none).
struct Times {
  double classify = 0.3, better = 1.6, other = 0.6, samples = 0;
};

struct Case {
  const char* name;
  Times real, calibrated;
  Factor device, better; // factors on times
  int frames = 3600;
  int good_from = 180; // from here on, the better technique must run in 99 % of the frames
  bool timestamps = true;
};

void PrintTo(const Case& one, std::ostream* out) {
  *out << one.name;
}

Scenario make(const Case& tried) {
  Scenario scenario;
  scenario.view_tiles = scenario.tiles = tiles;
  scenario.latency = 2;
  const double real[] = {tried.real.classify, tried.real.better, tried.real.other,
                         tried.real.samples};
  const double calibrated[] = {tried.calibrated.classify, tried.calibrated.better,
                               tried.calibrated.other, tried.calibrated.samples};
  const size_t count = tried.real.samples > 0 ? 4 : 3;
  for (size_t p = 0; p < count; ++p) {
    const double base = p == 3 ? 0 : 0.2; // fraction
    SimulatedPass& pass = scenario.passes.emplace_back();
    pass.base_ms = base * real[p];
    pass.group_ms = (1 - base) * real[p] / tiles;
    pass.calibrated_base_ms = base * calibrated[p];
    pass.calibrated_group_ms = (1 - base) * calibrated[p] / tiles;
    pass.noise = 0.05;
  }
  scenario.configurations = {{{0, 1}, -1, 1.9e-3, 1.9e-3}, {{0, 2}, -1, 4e-3, 4e-3}};
  if (count == 4) scenario.configurations[0] = {{0, 1}, 3, 1.2e-3, 1.9e-3};
  set_frames(scenario, tried.frames);
  for (int t = 0; t < tried.frames; ++t) {
    const auto index = static_cast<size_t>(t);
    scenario.clock[index] = tried.device(t);
    scenario.factors[index].push_back({1, tried.better(t)});
    scenario.without_timestamps[index] = tried.timestamps ? 0 : 1;
  }
  return scenario;
}

struct Regressions : ::testing::TestWithParam<Case> {};

TEST_P(Regressions, BetterTechniqueReturns) {
  const Case& tried = GetParam();
  const Scenario scenario = make(tried);
  const auto run = run_scenario(scenario, budget_ms, 7);
  int worse = 0;
  double units = 0;
  const auto judged = std::span(run).subspan(static_cast<size_t>(tried.good_from));
  for (const RunFrame& frame : judged) {
    worse += frame.configuration != 0 ? 1 : 0;
    units += frame.units / static_cast<double>(judged.size());
  }
  EXPECT_LE(worse, static_cast<int>(judged.size()) / 100);
  if (tried.real.samples == 0) return;
  constexpr double margin = 0.11; // more than the noise of the times needs
  const double fit = (budget_ms * std::exp(-margin) - tried.real.classify - tried.real.better) /
                     tried.real.samples * 1000;
  EXPECT_GT(units, 0.8 * std::min(fit, requested_units(tiles)));
}

constexpr Times usual;
constexpr Times sampled{0.3, 1.6, 0.6, 0.5};
INSTANTIATE_TEST_SUITE_P(
    Cases, Regressions,
    ::testing::Values(
        Case{"Steady", usual, usual, one, one},
        Case{"ShortHitch", usual, usual, between(600, 606, 4), one, 4500, 606 + 180},
        Case{"SecondOfSlowDevice", usual, usual, between(600, 660, 1.5), one, 4500, 660 + 180},
        Case{"FiveSecondsOfSlowDevice", usual, usual, between(600, 900, 2), one, 4500, 900 + 180},
        Case{"MinuteOfSlowDevice", usual, usual, between(600, 4200, 2), one, 9000, 4200 + 180},
        Case{"SecondOfSlowPass", usual, usual, one, between(600, 660, 3), 4500, 660 + 180},
        // may take as long as the disturbance
        Case{"TenSecondsOfSlowPass", usual, usual, one, between(600, 1200, 3), 4500, 1800 + 60},
        Case{"CalibrationTooHigh", usual, {0.3, 2.6, 0.6}, one, one},
        Case{"CalibrationThreeTimesTooHigh", usual, {0.3, 4.8, 0.6}, one, one},
        Case{"CalibrationAThird", usual, {0.1, 0.53, 0.2}, one, one},
        Case{"NoTimestamps", usual, usual, one, one, 3600, 180, false},
        Case{"Samples", sampled, sampled, one, one},
        Case{"NoSamplesForFiveSeconds", sampled, sampled, between(600, 900, 1.3), one, 3600,
             900 + 180},
        Case{"UnitsCheaperThanCalibrated", {0.3, 1.6, 0.6, 0.2}, {0.3, 1.6, 0.6, 0.6}, one, one}),
    [](const auto& info) { return info.param.name; });

} // namespace
} // namespace dermis::choice_test
