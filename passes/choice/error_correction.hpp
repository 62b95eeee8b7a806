#pragma once
// What an error probe found beside what the table expects: a factor on a technique's expected error, for this
// content. Robust against frames in which the probe met what is rare, and forgotten where it is not seen.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace dermis::choice {

// Sums of squares that count less with each probed frame. Plain data.
struct ErrorCorrection {
  struct Line {
    double probed = 0, expected = 0;
    double newest = 0; // expected square of the newest frame
  };
  std::vector<Line> lines; // by technique + 1: the first is where none runs
};

// For `techniques` of an error table; nothing is known yet.
ErrorCorrection make_error_correction(size_t techniques);
// One probed frame: of `technique` (-1: none ran) `probed` was found where the table says `expected`; both
// are root mean squares > 0, others tell nothing. What is known of the other techniques fades. Allocates
// nothing.
void observe_error(ErrorCorrection& correction, int32_t technique, double probed, double expected);
// 1/4 .. 4; 1 where nothing is known.
double error_factor(const ErrorCorrection& correction, int32_t technique);

} // namespace dermis::choice
