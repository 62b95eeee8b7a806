#pragma once
// What may go wrong with what a host hands over, as short sequences of small frames, each with what must come
// out all the same. The list follows what is known to break scattering, pyramids and histories.

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

// What of a run is held against what must come out.
enum class Judged : uint8_t {
  light,           // each pixel; the largest error
  light_rms,       // of a frame, the root of the mean square
  light_beyond,    // how far light is below 0 or above `scale`, in units of it
  tile_edges,      // means of columns and of rows that lie alike in tiles; how far one is off all of them
  mean_samples,    // the mean number of samples, in units of that of `same_as`
  samples_at_edge, // least number of samples over the mean of it in the columns beside the middle
  samples_in_tile, // the most of a tile over its mean
};

// Which techniques a case is for.
enum class Asked : uint8_t {
  all,
  with_history, // those that keep something from frame to frame
  guided,       // those whose number of samples follows what they found
  of_profile,   // those whose kernel is the profile's: not separable_jimenez
};

struct StabilityCase {
  std::string_view name;
  uint32_t frames = 1;
  std::function<CapturedFrame(uint32_t frame)> given;
  // What must come out: the technique's own answer to this sequence, or, where there is none, what `wanted`
  // says for pixels with a profile (all channels alike), or, where there is neither, the light that came.
  // Pixels without a profile keep their light.
  std::function<CapturedFrame(uint32_t frame)> same_as = nullptr;
  std::function<double(uint32_t frame)> wanted = nullptr;
  Judged judged = Judged::light;
  Asked requested = Asked::all;
  double bound = 0;           // of the error, in units of `scale`
  double scale = 1;           // brightest light of the judged frames
  uint32_t first_channel = 0; // that is judged
  uint32_t margin = 0;        // pixels along the border that are not judged
  uint32_t first_judged = 0;  // errors count from here on; values that are not finite always do
  uint32_t damage_ends =
      0;               // frames from here on are sound: how many more until the error is within the bound
  bool follows = true; // false: every frame is a cut
  bool finite_only = false;                     // nothing is asked but finite values, none below 0
  bool may_be_rejected = false;                 // a graph may say that it cannot be made for this size
  bool large = false;                           // millions of pixels, hundreds of frames: not for a quick run
  DepthGiven depth = DepthGiven::view_distance; // of `given`; `same_as` gives distances
  uint64_t frame_index = 0;                     // of the first frame; 0: as it comes
};

inline constexpr uint32_t stability_side = 48; // pixels, of frames whose size is not the point
inline constexpr double stability_d_px = 4;
inline constexpr double furnace = 2e-3; // bound of a white furnace through half floats: two steps of 2^-10
inline constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN(),
                       infinity = std::numeric_limits<float>::infinity();

// Five profiles: ids 1 and 2, the second twice as wide; 3, of which blue does not scatter, and 4 and 5, of
// which it has a thousandth and a hundredth of the width.
std::vector<CaptureProfile> stability_profiles();
// A white plane under light 1, all of profile 1.
CapturedFrame sound_frame(uint32_t width = stability_side, uint32_t height = stability_side,
                          double d_px = stability_d_px);
// Smooth light with contrast .4 around .5.
void set_texture(CapturedFrame& frame);
CapturedFrame textured_frame();
// The same value in three channels.
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
