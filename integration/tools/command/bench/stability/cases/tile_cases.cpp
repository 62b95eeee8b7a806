// Tiles of 8x8 pixels and their groups must not be visible.
#include "integration/tools/command/bench/stability/cases.hpp"

namespace dermis::tools {
namespace {

// A light ramp must scatter to itself. Differences between columns, or rows, by their position in a
// tile are seams.
StabilityCase seams() {
  constexpr uint32_t side = 192; // pixels: eight times two tiles inside the margin
  constexpr double d_px = 2;
  StabilityCase made;
  made.name = "tile_edges_in_a_ramp";
  made.given = [](uint32_t) {
    CapturedFrame frame = sound_frame(side, side, d_px);
    for (uint32_t y = 0; y < side; ++y)
      for (uint32_t x = 0; x < side; ++x)
        set_light(frame, x, y, static_cast<float>(0.1 + 0.8 * (x + y) / (2.0 * side)));
    return frame;
  };
  made.judged = Judged::tile_edges;
  made.margin = 32;     // 16 d: all but 4e-3 of a pixel's light comes from within
  made.bound = 0x1p-11; // one half float step below 1
  return made;
}

// More tiles than the maximum group count of many devices along one axis (65,535).
StabilityCase many_tiles() {
  StabilityCase made;
  made.name = "size_4096x1032"; // 66,048 tiles
  made.given = [](uint32_t) { return sound_frame(4096, 1032); };
  made.wanted = [](uint32_t) { return 1.0; };
  made.bound = furnace;
  made.large = true;
  return made;
}

} // namespace

std::vector<StabilityCase> tile_cases() {
  return {seams(), many_tiles()};
}

} // namespace dermis::tools
