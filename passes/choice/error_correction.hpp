#pragma once
// Error correction: factors on expected errors for the present content, from error probes. One
// factor, of unscattered light, is common to all techniques: how bright and how detailed the light
// is. Others are those of single techniques, relative to it in the same frames. Robust against
// frames in which the probe hit rare content. What was measured holds until the content changes, so
// that a choice between techniques settles.

#include "passes/choice/error_model.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace dermis::choice {

// Sums of squares of recent probed frames, and the table that they correct. Plain data.
struct ErrorCorrection {
  struct Line {
    double probed = 0, expected = 0; // sums
    double frames = 0;               // number of frames in the sums; 0: none
    double seen_s = 0;               // time and content of the newest frame
    uint32_t cuts = 0;               // since then
    FrameKey key;
  };
  std::vector<Line> lines; // by technique + 1; the first is that of unscattered light
  // Frames in which only selected tiles scattered: the squares that were left, of those without
  // scattering, both less those with all tiles; and the mean logarithm of the fraction of the tiles
  // that did not scatter.
  Line selection;
  double selection_log = 0;
  std::vector<TechniqueError> techniques; // rows of the table
  int32_t compared = -1;                  // technique that all probed frames measure; -1: none
  // Newest frames in a row whose light was much brighter, or if negative darker, than known.
  int steps = 0;
};

// A frame whose error was probed.
struct ProbedFrame {
  int32_t technique = -1; // -1: none ran
  // mean squared errors of the picture and of its light before scattering; noisy, may be negative
  double square = 0, unscattered_square = 0;
  double expected = 0, expected_unscattered = 0; // RMSE by the table
  FrameKey key;
  double now_s = 0; // seconds
  // The same of ErrorCorrection::compared, whether or not it runs, in the same pixels.
  double compared_square = 0, compared_expected = 0;
  // If only selected tiles show `compared`: mean squared error of the picture, and the selected
  // fraction of the tiles; else 0.
  double selection_square = 0, selected = 0;
};

// Creates a correction of an error table, without observations. Techniques are variants if the type
// of their first pass is equal. `compared` is subsurface.separable with 25 taps, as of the probe.
ErrorCorrection make_error_correction(const ErrorModel& table);
// Adds a frame. Ignores values that are not finite, and frames whose expected errors are not
// positive. Allocates nothing.
void observe_error(ErrorCorrection& correction, const ProbedFrame& frame);
// Returns the factor for a frame with this content at this time. It returns to that of the
// technique's variants, and theirs to 1, as the last probed frame ages, and as the content deviates
// from that frame's. `cut`: the frame replaces the content, and forget_errors() is yet to be
// called.
double error_factor(const ErrorCorrection& correction, int32_t technique, const FrameKey& key,
                    double now_s, bool cut = false);
// Returns the number of probed frames that say something about the technique's error in a frame
// with this content at this time; older and different ones count less.
double measured_frames(const ErrorCorrection& correction, int32_t technique, const FrameKey& key,
                       double now_s, bool cut = false);
// Returns the exponent of (1 - selected fraction) in the mean squared error that is left if only
// selected tiles scatter: as measured, or `expected` where the measurements do not apply.
double selection_concentration(const ErrorCorrection& correction, double expected,
                               const FrameKey& key, double now_s, bool cut = false);
// Call it when the content was replaced, for example by a camera cut. Sets the factors of
// techniques that do not run to 1, and the exponent of selection_concentration() to that of the
// error table.
void forget_errors(ErrorCorrection& correction);
// Takes back the last forget_errors(), whose frame was discarded.
void recall_errors(ErrorCorrection& correction);

} // namespace dermis::choice
