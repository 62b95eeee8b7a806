#pragma once
// How pass types dispatch. A tile has 8x8 pixels; a group of most kernels covers one tile.

#include "framegraph/model/dispatch_rule.hpp"

namespace dermis::subsurface {

inline constexpr uint32_t tile_side = 8; // pixels

// One group per tile of the render rectangle.
inline constexpr DispatchRule over_view{.name = "over_view", .cell_side = tile_side};
// One group per listed tile.
inline constexpr DispatchRule over_tiles{.name = "over_tiles",
                                         .domain = DispatchRule::Domain::indirect};
// One invocation per tile of the render rectangle.
inline constexpr DispatchRule over_tile_grid{
    .name = "over_tile_grid", .cell_side = tile_side, .cells_per_group = 64};
// One group per 4x4 tiles of the render rectangle.
inline constexpr DispatchRule over_tile_blocks{.name = "over_tile_blocks",
                                               .cell_side = 4 * tile_side};
// One group per run of tiles of the render rectangle, row by row.
inline constexpr uint32_t tiles_per_run_group = 1024;
inline constexpr DispatchRule over_tile_runs{.name = "over_tile_runs",
                                             .cell_side = tile_side,
                                             .cells_per_group = tiles_per_run_group,
                                             .invocations = 128};
inline constexpr uint32_t max_probes = 32; // probed tiles per frame
// One group per tile that subsurface.probe can select: one in each run of 64 tiles, or max_probes.
constexpr DispatchRule over_probed_tiles(uint32_t invocations) {
  return {.name = "probed_tiles",
          .cell_side = tile_side,
          .cells_per_group = 64,
          .invocations = invocations,
          .max_groups = max_probes};
}
// One group per tile of level 4 of the surface-aware pyramid, whose border has one texel of 16
// pixels on each side.
inline constexpr DispatchRule over_tile_regions{
    .name = "over_tile_regions", .cell_side = 16 * tile_side, .invocations = 128, .border = 2 * 16};
// One group per 8x8 texels of the first image that the pass type writes.
inline constexpr DispatchRule over_written_image{.name = "over_written",
                                                 .domain = DispatchRule::Domain::written_image};
inline constexpr DispatchRule single_group{.name = "single_group",
                                           .domain = DispatchRule::Domain::one};
inline constexpr DispatchRule no_dispatch{.name = "none", .domain = DispatchRule::Domain::none};

// Returns the number of tiles that cover `width` x `height` pixels.
constexpr uint64_t tile_count(uint64_t width, uint64_t height) {
  return group_count(over_view, width, height).total();
}

} // namespace dermis::subsurface
