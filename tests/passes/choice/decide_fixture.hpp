#pragma once
// Forecasts and frames for tests of decide().

#include "passes/choice/budget_controller.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace dermis::deciding {

using namespace dermis::choice;

inline constexpr double frame_seconds = 1.0 / 60;
inline constexpr double margin = 0.05;

inline Forecast known(double ms, double rmse, double missed_rmse = 0) {
  Forecast forecast;
  forecast.time.expected_ms = forecast.time.pessimistic_ms = forecast.time.optimistic_ms =
      forecast.time.undisturbed_ms = forecast.time.usual_ms = ms;
  forecast.time.measured = true;
  forecast.margin = margin;
  forecast.rmse = forecast.unsampled_rmse = rmse;
  forecast.missed_rmse = missed_rmse;
  return forecast;
}

// Never ran; takes 1/3 to 1.5 times `ms`.
inline Forecast unknown(double ms, double rmse) {
  Forecast forecast = known(ms, rmse);
  forecast.time.pessimistic_ms *= 1.5;
  forecast.time.optimistic_ms /= 3;
  forecast.time.undisturbed_ms /= 3;
  forecast.time.measured = false;
  return forecast;
}

inline const std::vector<Forecast> three{known(1, 9e-3), known(2, 5e-3), known(4, 2e-3)};

struct Decide : ::testing::Test {
  DecisionState state;
  FrameInput frame;

  Decision decide(std::vector<Forecast> forecasts, double budget_ms,
                  double seconds = frame_seconds) {
    if (state.configurations.empty()) restart(state, forecasts.size(), 0);
    frame.budget_ms = budget_ms;
    frame.seconds = seconds;
    std::vector<Assessment> scratch(forecasts.size());
    return dermis::choice::decide(forecasts, frame, state, scratch);
  }
};

} // namespace dermis::deciding
