// Adaptive numbers of samples: how fast they adapt, and what must not change them.
#include "integration/tools/command/bench/stability/cases.hpp"

#include <algorithm>

namespace dermis::tools {
namespace {

// Light and dark halves.
CapturedFrame edge_frame() {
  CapturedFrame frame = sound_frame();
  for (uint32_t y = 0; y < stability_side; ++y)
    for (uint32_t x = 0; x < stability_side / 2; ++x)
      set_light(frame, x, y, 0);
  return frame;
}

// 600 frames of uniform light leave no variance; then an edge appears. In its second frame, pixels
// at the edge must take at least twice the minimum number of samples.
StabilityCase wakes_up() {
  constexpr uint32_t comes = 600; // frame
  StabilityCase made;
  made.name = "samples_after_600_even_frames";
  made.frames = comes + 3;
  made.given = [](uint32_t frame) { return frame < comes ? sound_frame() : edge_frame(); };
  made.judged = Judged::samples_at_edge;
  made.requested = Asked::guided;
  made.large = true;
  made.first_judged = comes + 1;
  made.bound = 0.5;
  return made;
}

// Light in other units with a matching exposure must give the same numbers of samples.
StabilityCase in_other_units() {
  const auto with = [](float change) {
    return [change](uint32_t frame) {
      CapturedFrame out = edge_frame();
      if (frame < 8) return out;
      for (float& value : out.lighting.values)
        value *= change;
      out.description.exposure = 1 / change;
      return out;
    };
  };
  StabilityCase made;
  made.name = "samples_under_exposure_x16";
  made.frames = 24;
  made.given = with(16);
  made.same_as = with(1);
  made.judged = Judged::mean_samples;
  made.requested = Asked::guided;
  made.bound = 0.02;
  return made;
}

// A pixel with many samples stalls its group. The maximum over the mean of a tile is bounded by the
// range of sample counts (8 to 64).
StabilityCase uneven() {
  StabilityCase made;
  made.name = "samples_in_a_tile";
  made.frames = 24;
  made.given = [](uint32_t) { return edge_frame(); };
  made.judged = Judged::samples_in_tile;
  made.requested = Asked::guided;
  made.bound = 8;
  return made;
}

} // namespace

std::vector<StabilityCase> guidance_cases() {
  return {wakes_up(), in_other_units(), uneven()};
}

} // namespace dermis::tools
