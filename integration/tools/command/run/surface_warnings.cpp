#include "integration/tools/command/run/surface_warnings.hpp"
#include "passes/common/dispatch.hpp"
#include "passes/common/reference/surface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace dermis::tools {
namespace {

using subsurface::tile_side;

// Depths of one frame, and sides of a pixel.
struct DepthPicture {
  const CapturedFrame& frame;

  bool holds(uint32_t x, uint32_t y, uint8_t id) const {
    const size_t i = size_t{y} * frame.description.width + x;
    return frame.profile[i] == id && frame.depth.values[i] > 0;
  }
  double at(uint32_t x, uint32_t y) const {
    return double(frame.depth.values[size_t{y} * frame.description.width + x]);
  }
  // Returns whether both neighbours along the axis are nearer or both farther than the pixel, each
  // beyond the slope of a patch.
  bool is_isolated(uint32_t x, uint32_t y, uint32_t dx, uint32_t dy) const {
    const Rectangle& render = frame.description.render;
    if (x < render.x + dx || y < render.y + dy || x + dx >= render.x + render.width ||
        y + dy >= render.y + render.height)
      return false;
    const uint8_t id = frame.profile[size_t{y} * frame.description.width + x];
    if (!holds(x - dx, y - dy, id) || !holds(x + dx, y + dy, id)) return false;
    const double depth = at(x, y), before = at(x - dx, y - dy) - depth,
                 after = at(x + dx, y + dy) - depth;
    const double side = std::abs(dx > 0 ? frame.rays.scale_x : frame.rays.scale_y) *
                        (frame.rays.perspective ? depth : 1.0);
    return before * after > 0 &&
           std::min(std::abs(before), std::abs(after)) > subsurface::max_patch_slope * side;
  }
};

bool holds(const Diagnostics& diagnostics, DiagnosticId id) {
  return std::any_of(diagnostics.list.begin(), diagnostics.list.end(),
                     [&](const Diagnostic& one) { return one.id == id; });
}

} // namespace

double pixel_aspect(const subsurface::PixelRays& rays) {
  const double x = std::abs(rays.scale_x), y = std::abs(rays.scale_y);
  return std::max(x, y) / std::min(x, y);
}

double dithered_tiles(const CapturedFrame& frame) {
  const Rectangle& render = frame.description.render;
  const DepthPicture picture{frame};
  size_t tiles = 0, dithered = 0;
  for (uint32_t top = render.y; top < render.y + render.height; top += tile_side)
    for (uint32_t left = render.x; left < render.x + render.width; left += tile_side) {
      const uint32_t right = std::min(left + tile_side, render.x + render.width),
                     bottom = std::min(top + tile_side, render.y + render.height);
      uint32_t pixels = 0, isolated = 0;
      for (uint32_t y = top; y < bottom; ++y)
        for (uint32_t x = left; x < right; ++x) {
          const uint8_t id = frame.profile[size_t{y} * frame.description.width + x];
          if (id == 0 || !picture.holds(x, y, id)) continue;
          ++pixels;
          isolated += picture.is_isolated(x, y, 1, 0) || picture.is_isolated(x, y, 0, 1);
        }
      tiles += pixels > 0;
      dithered += pixels > 0 && isolated >= tile_side && isolated * tile_side >= pixels;
    }
  return tiles > 0 ? double(dithered) / double(tiles) : 0;
}

bool warn_of_surfaces(const CapturedFrame& frame, Diagnostics& diagnostics) {
  const size_t before = diagnostics.list.size();
  const auto of_frame = [&](std::string text) {
    return fmt::format("frame {}: {}", frame.description.frame_index, text);
  };
  if (const double aspect = pixel_aspect(frame.rays);
      aspect > largest_compensated_aspect && !holds(diagnostics, DiagnosticId::pixels_not_square))
    diagnostics.add(
        DiagnosticId::pixels_not_square, {},
        of_frame(fmt::format(
            "pixels are {:.2f} times as {} as in the other direction; pyramids "
            "follow the shape of pixels up to {:.0f}, and scatter too far along the longer side",
            aspect, std::abs(frame.rays.scale_x) > std::abs(frame.rays.scale_y) ? "wide" : "high",
            largest_compensated_aspect)));
  if (!holds(diagnostics, DiagnosticId::surface_dithered))
    if (const double tiles = dithered_tiles(frame); tiles > largest_folded_tiles)
      diagnostics.add(DiagnosticId::surface_dithered, {},
                      of_frame(fmt::format(
                          "{:.0f} % of the tiles with subsurface alternate between two depths "
                          "from pixel to pixel, as dithered surfaces do; techniques that are not "
                          "based on 'sap' mix the light of both",
                          100 * tiles)));
  return diagnostics.list.size() > before;
}

} // namespace dermis::tools
