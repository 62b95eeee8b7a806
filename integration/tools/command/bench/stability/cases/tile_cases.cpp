// What tiles of 8x8 pixels and the groups that run them must not show.
#include "integration/tools/command/bench/stability/cases.hpp"

namespace dermis::tools {
namespace {

// Light that rises evenly scatters to itself: what differs between columns, or rows, of one place in a tile
// and those of another is a seam.
StabilityCase seams() {
  constexpr uint32_t side = 192; // pixels: eight times two tiles, beside the border
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
  made.margin = 32;     // 16 d: all but 4e-3 of a pixel's light is from within
  made.bound = 0x1p-11; // a step of a half float below 1
  return made;
}

// More tiles than a dispatch has groups along one side on many devices (65,535).
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
