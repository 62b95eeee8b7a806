// Selection of the tiles that scatter if not all fit the budget.

#include "passes/common/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {

constexpr Port tile_changes = port::read_buffer(
    "tile_changes", "uint",
    "per tile of the render rectangle: expected squared change by scattering; bit "
    "31: weights in the tile may not fall to 0 in this frame");
constexpr Port histogram =
    port::read_buffer("histogram", "uint",
                      "per run of 1,024 tiles in row order: number of tiles that scatter by bin of "
                      "expected change (256 bins), then of those without bit 31");

constexpr Port tile_change_ports[] = {
    port::classes,
    port::read_buffer("light_range", "uvec4", "output of subsurface.classify"),
    port::importance,
    port::where_covered(port::material),
    port::where_covered(port::depth),
    port::where_covered(port::velocity),
    port::states_before,
    port::where_covered(port::pixel_weights_before),
    port::writer_of(tile_changes),
};

constexpr Port tile_histogram_ports[] = {
    port::classes,
    tile_changes,
    port::writer_of(histogram),
};

constexpr Port select_tiles_ports[] = {
    {"classes", Usage::storage_buffer_update, false, "uint",
     "output of subsurface.classify; tiles that are not selected become copied tiles"},
    tile_changes,
    histogram,
    port::states_before,
    port::list_state,
    port::writer_of(port::tile_states),
    port::written_buffer("selected_tiles", "uint", "list of the selected tiles, as 'tiles'"),
    port::written_buffer("selected_arguments", "uint",
                         "group counts of an indirect dispatch over the selected tiles"),
};

} // namespace

const PassType tile_change_type{
    .name = "subsurface.tile_change",
    .shader = "common/subsurface_tile_change",
    .doc = "Estimates by how much scattering changes each tile, from the range of light around it.",
    .ports = tile_change_ports,
    .settings = {},
    .dispatch = over_tile_grid,
};

const PassType tile_histogram_type{
    .name = "subsurface.tile_histogram",
    .shader = "common/subsurface_tile_histogram",
    .doc = "Counts tiles by their expected change, for subsurface.select_tiles.",
    .ports = tile_histogram_ports,
    .settings = {},
    .dispatch = over_tile_runs,
};

const PassType select_tiles_type{
    .name = "subsurface.select_tiles",
    .shader = "common/subsurface_select_tiles",
    .doc = "Selects the tiles that scattering changes most, as many as the frame's budget allows.",
    .ports = select_tiles_ports,
    .settings = {},
    .dispatch = over_tile_runs,
};

} // namespace dermis::subsurface
