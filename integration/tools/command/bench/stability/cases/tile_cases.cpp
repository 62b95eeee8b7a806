// Tiles of 8x8 pixels and their groups must not be visible.
#include "integration/tools/command/bench/stability/cases.hpp"

namespace dermis::tools {
namespace {

// A light ramp must scatter to itself. Differences between columns, or rows, by their position in a
// tile are seams.
StabilityCase seams() {
  constexpr uint32_t side = 192; // pixels: eight times two tiles inside the margin
  constexpr double d_px = 2;
  const auto given = [](uint32_t) {
    CapturedFrame frame = sound_frame(side, side, d_px);
    for_pixels(frame, [&](uint32_t x, uint32_t y, size_t) {
      set_light(frame, x, y, static_cast<float>(0.1 + 0.8 * (x + y) / (2.0 * side)));
    });
    return frame;
  };
  return {.name = "tile_edges_in_a_ramp",
          .given = given,
          .metric = Metric::tile_edges,
          .bound = 0x1p-11, // one half float step below 1
          .margin = 32};    // 16 d: all but 4e-3 of a pixel's light comes from within
}

} // namespace

std::vector<StabilityCase> tile_cases() {
  // more tiles (66,048) than the maximum group count of many devices along one axis (65,535)
  const StabilityCase many{.name = "size_4096x1032",
                           .given = [](uint32_t) { return sound_frame(4096, 1032); },
                           .expected = white,
                           .bound = furnace,
                           .large = true};
  return {seams(), many};
}

} // namespace dermis::tools
