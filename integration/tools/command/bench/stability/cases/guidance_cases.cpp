// Adaptive numbers of samples: how fast they adapt, and what must not change them.
#include "integration/tools/command/bench/stability/cases.hpp"

#include <algorithm>

namespace dermis::tools {
namespace {

// Light and dark halves.
CapturedFrame edge_frame() {
  CapturedFrame frame = sound_frame();
  for_pixels(frame, [&](uint32_t x, uint32_t y, size_t) {
    if (!is_right_half(x)) set_light(frame, x, y, 0);
  });
  return frame;
}

// 600 frames of uniform light leave no variance; then an edge appears. In its second frame, pixels
// at the edge must take at least twice the minimum number of samples.
StabilityCase wakes_up() {
  constexpr uint32_t comes = 600; // frame
  return {.name = "samples_after_600_even_frames",
          .frames = comes + 3,
          .given = [](uint32_t frame) { return frame < comes ? sound_frame() : edge_frame(); },
          .metric = Metric::samples_at_edge,
          .applies_to = AppliesTo::guided,
          .bound = 0.5,
          .first_judged = comes + 1,
          .large = true};
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
  return {.name = "samples_under_exposure_x16",
          .frames = 24,
          .given = with(16),
          .same_as = with(1),
          .metric = Metric::mean_samples,
          .applies_to = AppliesTo::guided,
          .bound = 0.02};
}

// A pixel with many samples stalls its group. The maximum over the mean of a tile is bounded by the
// range of sample counts (8 to 64).
StabilityCase uneven() {
  return {.name = "samples_in_a_tile",
          .frames = 24,
          .given = [](uint32_t) { return edge_frame(); },
          .metric = Metric::samples_in_tile,
          .applies_to = AppliesTo::guided,
          .bound = 8};
}

} // namespace

std::vector<StabilityCase> guidance_cases() {
  return {wakes_up(), in_other_units(), uneven()};
}

} // namespace dermis::tools
