// Classification of 8x8 tiles, and the list of tiles with subsurface that indirect dispatches run
// over.

#include "passes/common/dispatch.hpp"
#include "passes/common/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {

constexpr std::string_view light_range_doc =
    "per tile: minimum and maximum of the light that can scatter, and the widest d (light_range.glsl)";

constexpr std::string_view light_cells_doc = "light_range of each block of 4x4 tiles, row by row";

constexpr Port classify_ports[] = {
    port::material,
    port::depth,
    port::scatter_scale,
    {"lighting", Usage::sampled_image, true, "texture2D",
     "diffuse irradiance before albedo, linear; for light_range and light_cells", port::color_formats},
    port::albedo,
    {"classes",
     Usage::storage_buffer_write,
     false,
     "uint",
     "per tile of the render rectangle, row by row: 0: no subsurface; 1: scatters; 2: scattering below a "
     "pixel (copy); 3: uniform light (copy); plus 4 if all 64 pixels have subsurface",
     {}},
    {"light_range", Usage::storage_buffer_write, true, "uvec4", light_range_doc, {}},
    {"light_cells", Usage::storage_buffer_write, true, "uvec4", light_cells_doc, {}},
};
constexpr PassTypeSetting classify_settings[] = {setting::texturing};

constexpr Port flat_ports[] = {
    {"light_range", Usage::storage_buffer_read, false, "uvec4", light_range_doc, {}},
    {"light_cells", Usage::storage_buffer_read, false, "uvec4", light_cells_doc, {}},
    {"classes", Usage::storage_buffer_update, false, "uint", "output of subsurface.classify", {}},
};

constexpr Port tile_list_ports[] = {
    {"classes", Usage::storage_buffer_read, false, "uint", "output of subsurface.classify", {}},
    {"tiles", Usage::storage_buffer_write, false, "uint", port::tiles.doc, {}},
    {"arguments", Usage::storage_buffer_write, false, "uint", port::arguments.doc, {}},
};

constexpr Port skips_ports[] = {
    {"classes",
     Usage::storage_buffer_read,
     false,
     "uint",
     "output of subsurface.classify or subsurface.classify_uniform_light",
     {}},
    port::material,
    {"skips", Usage::storage_image_write, true, "image2D",
     "for tools: class of the pixel's tile, profile id of the pixel, 0, 1", port::light_formats},
};

} // namespace

const PassType classify_type{
    .name = "subsurface.classify",
    .shader = "common/subsurface_classify",
    .doc = "Classifies 8x8 tiles by material and projected scattering radius.",
    .ports = classify_ports,
    .settings = classify_settings,
    .dispatch = over_tile_blocks,
    .side_effects = false,
};

const PassType classify_uniform_light_type{
    .name = "subsurface.classify_uniform_light",
    .shader = "common/subsurface_classify_uniform_light",
    .doc = "Reclassifies tiles as copied if their light is uniform within the reach of scattering.",
    .ports = flat_ports,
    .settings = {},
    .dispatch = over_tile_grid,
    .side_effects = false,
};

const PassType debug_tile_class_type{
    .name = "subsurface.debug_tile_class",
    .shader = "common/subsurface_debug_tile_class",
    .doc = "Writes the class of each tile for tools.",
    .ports = skips_ports,
    .settings = {},
    .dispatch = over_view,
    .side_effects = false,
};

const PassType tile_list_type{
    .name = "subsurface.tile_list",
    .shader = "common/subsurface_tile_list",
    .doc = "Compacts tile classes into a list in row order and its indirect arguments (a scan without "
           "atomics, so that the list is deterministic).",
    .ports = tile_list_ports,
    .settings = {},
    .dispatch = single_group,
    .side_effects = false,
};

} // namespace dermis::subsurface
