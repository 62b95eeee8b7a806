#pragma once
// Error correction: a factor on a technique's expected error for the present content, from error
// probes. Robust against frames in which the probe hit rare content; old frames are forgotten.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace dermis::choice {

// Sums of squares with exponential decay per probed frame. Plain data.
struct ErrorCorrection {
  struct Line {
    double probed = 0, expected = 0;
    double newest = 0; // expected square of the newest frame
  };
  std::vector<Line> lines; // by technique + 1; the first is for frames without a technique
};

// Creates a correction for `techniques` of an error table, without observations.
ErrorCorrection make_error_correction(size_t techniques);
// Adds one probed frame: `technique` (-1: none ran) had the error `probed`, while the table expects
// `expected`. Both are root mean squares. Ignores values that are not finite, a negative `probed`,
// and `expected` <= 0. Knowledge of the other techniques fades. Allocates nothing.
void observe_error(ErrorCorrection& correction, int32_t technique, double probed, double expected);
// Returns the factor, 1/4 .. 4; 1 without observations.
double error_factor(const ErrorCorrection& correction, int32_t technique);

} // namespace dermis::choice
