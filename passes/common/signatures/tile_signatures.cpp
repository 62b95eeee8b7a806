// Classification of 8x8 tiles, and the list of tiles with subsurface that indirect dispatches run
// over.

#include "passes/common/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {

constexpr Port light_range = port::read_buffer("light_range", "uvec4",
                                               "per tile: minimum and maximum of the light that "
                                               "can scatter, and the widest d (light_range.glsl)");
constexpr Port light_cells =
    port::read_buffer("light_cells", "uvec4", "light_range of each block of 4x4 tiles, row by row");

constexpr Port classify_ports[] = {
    port::material,
    port::where_covered(port::depth),
    port::where_covered(port::scatter_scale),
    port::where_covered(port::optional(port::sampled(
        "lighting", "diffuse irradiance before albedo, linear; for light_range and light_cells",
        port::color_formats))),
    port::where_covered(port::albedo),
    port::written_buffer(
        "classes", "uint",
        "per tile of the render rectangle, row by row: 0: no subsurface; 1: scatters; 2: "
        "scattering below a "
        "pixel (copy); 3: uniform light (copy); plus 4 if all 64 pixels have subsurface"),
    port::optional(port::writer_of(light_range)),
    port::optional(port::writer_of(light_cells)),
    port::optional(port::writer_of(port::list_state)),
};
constexpr PassTypeSetting classify_settings[] = {
    setting::texturing,
    setting::boolean("relief", "counts how much of the surface leaves the pixels' tangent planes, "
                               "from which the choice by budget expects errors"),
};

constexpr Port uniform_light_ports[] = {
    light_range,
    light_cells,
    {"classes", Usage::storage_buffer_update, false, "uint", port::classes.doc},
};

constexpr Port tile_list_ports[] = {
    port::classes,
    port::list_state,
    port::where_covered(port::writer_of(port::tiles)),
    port::writer_of(port::arguments),
};

constexpr Port debug_tile_class_ports[] = {
    port::read_buffer("classes", "uint",
                      "output of subsurface.classify or subsurface.classify_uniform_light"),
    port::material,
    port::optional(port::written(
        "tile_class", "for tools: class of the pixel's tile, profile id of the pixel, 0, 1",
        port::light_formats)),
};

} // namespace

const PassType classify_type{
    .name = "subsurface.classify",
    .shader = "common/subsurface_classify",
    .doc = "Classifies 8x8 tiles by material and projected scattering radius.",
    .ports = classify_ports,
    .settings = classify_settings,
    .dispatch = over_tile_blocks,
};

const PassType classify_uniform_light_type{
    .name = "subsurface.classify_uniform_light",
    .shader = "common/subsurface_classify_uniform_light",
    .doc = "Reclassifies tiles as copied if their light is uniform within the reach of scattering.",
    .ports = uniform_light_ports,
    .settings = {},
    .dispatch = over_tile_grid,
};

const PassType debug_tile_class_type{
    .name = "subsurface.debug_tile_class",
    .shader = "common/subsurface_debug_tile_class",
    .doc = "Writes the class of each tile for tools.",
    .ports = debug_tile_class_ports,
    .settings = {},
    .dispatch = over_view,
};

const PassType tile_list_type{
    .name = "subsurface.tile_list",
    .shader = "common/subsurface_tile_list",
    .doc = "Compacts tile classes into a list and its indirect arguments. Equal classes give equal "
           "sets "
           "of tiles, in an order that varies.",
    .ports = tile_list_ports,
    .settings = {},
    .dispatch = over_tile_runs,
};

} // namespace dermis::subsurface
