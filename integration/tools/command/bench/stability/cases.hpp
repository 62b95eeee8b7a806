#pragma once
// Invalid or extreme host inputs as short sequences of small frames, each with the required result.
// The list covers known problems of scattering, pyramids and histories.

#include "integration/tools/command/bench/technique.hpp"
#include "integration/tools/files/capture.hpp"

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

namespace dermis::tools {

// The quantity of a run that is compared with the required result.
enum class Metric : uint8_t {
  light,           // largest error of a pixel
  light_rms,       // RMS error of a frame
  light_beyond,    // amount by which light is below 0 or above `scale`, in units of `scale`
  tile_edges,      // largest deviation of the mean over columns, or rows, at one position in tiles
  mean_samples,    // mean number of samples, relative to that of `same_as`
  samples_at_edge, // minimum sample count over its mean in the columns around the middle
  samples_in_tile, // maximum over mean number of samples of a tile
};

// The techniques that a case applies to.
enum class AppliesTo : uint8_t {
  all,
  with_history, // techniques with history
  guided,       // techniques with an adaptive number of samples
  of_profile,   // techniques whose kernel is the profile: not separable_jimenez
};

struct StabilityCase {
  std::string_view name = {};
  uint32_t frames = 1;
  std::function<CapturedFrame(uint32_t frame)> given = nullptr;
  // The required result is the first available of: the technique's own result for `same_as`, the
  // value of `expected` for pixels with a profile (all channels), the input light. Pixels without a
  // profile keep their light.
  std::function<CapturedFrame(uint32_t frame)> same_as = nullptr;
  std::function<double(uint32_t frame)> expected = nullptr;
  Metric metric = Metric::light;
  AppliesTo applies_to = AppliesTo::all;
  double bound = 0;           // of the error, in units of `scale`
  double scale = 1;           // brightest light of the judged frames
  uint32_t first_channel = 0; // first judged channel
  uint32_t margin = 0;        // pixels along the border that are not judged
  uint32_t first_judged = 0;  // first frame whose errors count; non-finite values always count
  // First sound frame after damage; the row counts the frames until the error is within the bound.
  uint32_t damage_ends = 0;
  bool follows = true;          // false: every frame is a cut
  bool finite_only = false;     // only requires finite, non-negative values
  bool may_be_rejected = false; // a graph may reject this size
  bool large = false;           // millions of pixels or hundreds of frames; skipped in quick runs
  DepthGiven depth = DepthGiven::view_distance; // of `given`; `same_as` always gives distances
  uint64_t frame_index = 0;                     // of the first frame; 0: default numbering
};

inline constexpr uint32_t stability_side = 48; // pixels, of frames whose size is irrelevant
inline constexpr double stability_d_px = 4;
// bound of a white furnace with half floats: two steps of 2^-10
inline constexpr double furnace = 2e-3;
inline constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN(),
                       infinity = std::numeric_limits<float>::infinity();

// Returns six profiles. Ids 1 and 2: 2 is twice as wide. Id 3: blue does not scatter. Ids 4 and 5:
// blue has a thousandth and a hundredth of the width. Id 6: a dipole, whose falloff is tabulated.
std::vector<CaptureProfile> stability_profiles();
// Returns a white plane under light 1, all of profile 1.
CapturedFrame sound_frame(uint32_t width = stability_side, uint32_t height = stability_side,
                          double d_px = stability_d_px);
// Calls change(x, y, index) for each pixel of a frame.
template <class Change> void for_pixels(const CapturedFrame& frame, Change change) {
  for (uint32_t y = 0, i = 0; y < frame.description.height; ++y)
    for (uint32_t x = 0; x < frame.description.width; ++x, ++i)
      change(x, y, i);
}
// Required light of a white furnace, for StabilityCase::expected.
inline double white(uint32_t) {
  return 1;
}
inline bool is_right_half(uint32_t x) {
  return x >= stability_side / 2;
}
// Sets smooth light with contrast 0.4 around 0.5.
void set_texture(CapturedFrame& frame);
CapturedFrame textured_frame();
// Sets three channels to one value.
void set_light(CapturedFrame& frame, uint32_t x, uint32_t y, float value);
void fill_light(CapturedFrame& frame, float value);

std::vector<StabilityCase> light_cases();
std::vector<StabilityCase> shape_cases();
std::vector<StabilityCase> time_cases();
std::vector<StabilityCase> motion_cases();
std::vector<StabilityCase> depth_cases();
std::vector<StabilityCase> tile_cases();
std::vector<StabilityCase> guidance_cases();
std::vector<StabilityCase> random_cases();

} // namespace dermis::tools
