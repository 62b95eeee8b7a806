// The surface-aware pyramid: one pass type per step, one pass per level. Level 0 is the view. Level
// l has a texel every 2^l pixels and a border of one texel, which covers what lies beyond the last
// pixels.

#include "passes/common/dispatch.hpp"
#include "passes/common/signatures/level_ports.hpp"
#include "passes/sap/sap_weights.hpp"

namespace dermis::subsurface {

namespace {

// names of the first SapVariants
constexpr std::string_view variant_options[] = {"base", "smooth", "half"};

constexpr std::string_view light_doc =
    "rgb: light; a: fourth root of the surface's area divided by its cross-section";
constexpr std::string_view surface_doc =
    "depth in mm (bits of a float); slope x, y (halves); factor on d, fraction of the texel's kernel on its "
    "own surface (halves); profile id in bits 0-7 (0: no surface), bit 8: a second layer exists";
constexpr std::string_view scattered_doc =
    "scattered light of this level and coarser levels (3 halves), confidence (half), fraction of the kernel "
    "on the surface (3 halves), 0; in full storage: light (bits of 3 floats), the fraction and the "
    "confidence (a byte each)";

using port::light_formats;
using port::surface_formats;

constexpr PassTypeSetting level_setting(double first, std::string_view doc,
                                        double last = sap_level_count - 1) {
  return {.name = "level",
          .type = SettingType::integer,
          .default_value = integer_value(static_cast<int64_t>(first)),
          .minimum = first,
          .maximum = last,
          .options = {},
          .unit = "",
          .doc = doc};
}

constexpr PassTypeSetting variant =
    setting::choice("variant", variant_options,
                    "tent filter. base: at levels 0 and 1; smooth: at every level, which hides the grid; "
                    "half: at level 1, below subsurface.sap_gather_half",
                    1);

// Two layers at level 1 need a full first level, so `half` is not available.
constexpr PassTypeSetting layered_variant =
    setting::choice("variant", std::span(variant_options).first(2),
                    "tent filter. base: at levels 0 and 1; smooth: at every level, which hides the grid", 1);

constexpr std::string_view storage_options[] = {"half", "full"};
constexpr PassTypeSetting storage =
    setting::choice("storage", storage_options,
                    "precision of written light. half: half floats; full: floats, whose images need 32 bits "
                    "per channel. All passes of a pyramid must use the same value");

constexpr Port level_tiles{"level_tiles", Usage::storage_buffer_read,       false,
                           "uvec2",       "output of subsurface.sap_tiles", {}};
constexpr Port level_arguments{
    "level_arguments", Usage::indirect_arguments, false, "uint", "output of subsurface.sap_tiles", {}};

constexpr Port tiles_ports[] = {
    {"classes", Usage::storage_buffer_read, false, "uint", "output of subsurface.classify", {}},
    {"level_tiles",
     Usage::storage_buffer_write,
     false,
     "uvec2",
     "for each level, the index of its first entry and the number of entries; then the entries: tile x in "
     "bits 0-14, y in bits 15-29, bit 30: all pixels have subsurface, bit 31: copy only; then a mask of the "
     "3x3 tiles that can contain surface: bits 0-8 for the tiles of the finer level that the tile reduces, "
     "bits 9-17 for the tiles around it",
     {}},
    {"level_arguments",
     Usage::storage_buffer_write,
     false,
     "uint",
     "for each level, the group counts x, y, z of an indirect dispatch over its tiles, and x times y",
     {}},
    {"tiles", Usage::storage_buffer_write, false, "uint", port::tiles.doc, {}},
    {"arguments", Usage::storage_buffer_write, false, "uint", port::arguments.doc, {}},
    {"copy_arguments",
     Usage::storage_buffer_write,
     true,
     "uint",
     "like 'arguments', but 0 groups if any tile scatters, because the pyramid then also copies the other "
     "tiles. If the port is bound, the pyramid's lists are empty when no tile scatters",
     {}},
};

constexpr Port setup_ports[] = {
    {"lighting", Usage::sampled_image, false, "texture2D", "diffuse irradiance before albedo, linear",
     port::color_formats},
    port::material,
    port::depth,
    port::scatter_scale,
    port::albedo,
    level_tiles,
    level_arguments,
    {"light", Usage::storage_image_write, false, "image2D", light_doc, light_formats},
    {"surface", Usage::storage_image_write, false, "uimage2D", surface_doc, surface_formats},
};
constexpr PassTypeSetting setup_settings[] = {setting::texturing, storage};

constexpr Port halve_ports[] = {
    setup_ports[0],
    port::material,
    port::depth,
    port::scatter_scale,
    port::albedo,
    level_tiles,
    level_arguments,
    {"coarse_light", Usage::storage_image_write, false, "image2D", light_doc, light_formats},
    {"coarse_surface", Usage::storage_image_write, false, "uimage2D", surface_doc, surface_formats},
};
constexpr PassTypeSetting halve_settings[] = {level_setting(1, "level that the pass writes", 1),
                                              setting::texturing, storage};

constexpr Port down_ports[] = {
    {"light", Usage::sampled_image, false, "texture2D", "image of the finer level", light_formats},
    {"surface", Usage::sampled_image, false, "utexture2D", "image of the finer level", surface_formats},
    level_tiles,
    level_arguments,
    {"coarse_light", Usage::storage_image_write, false, "image2D", light_doc, light_formats},
    {"coarse_surface", Usage::storage_image_write, false, "uimage2D", surface_doc, surface_formats},
};
constexpr PassTypeSetting down_settings[] = {level_setting(1, "level that the pass writes"), storage};

// Ports of the second layer, for levels whose texels can have a second surface. Its images are
// valid only at texels whose first surface has the flag.
constexpr std::string_view second_doc = "image of the second layer, which holds surfaces apart from the "
                                        "first layer; undefined where a texel has only one layer";
constexpr Port second_coarse_surface{
    "second_coarse_surface", Usage::sampled_image, true, "utexture2D", second_doc, surface_formats};
constexpr Port second_coarse_scattered{
    "second_coarse_scattered", Usage::sampled_image, true, "utexture2D", second_doc, surface_formats};

constexpr Port up_ports[] = {
    {"light", Usage::sampled_image, false, "texture2D", "image of this level", light_formats},
    {"surface", Usage::sampled_image, false, "utexture2D", "image of this level", surface_formats},
    {"coarse_surface", Usage::sampled_image, true, "utexture2D",
     "image of the coarser level; unbound at the last level", surface_formats},
    {"coarse_scattered", Usage::sampled_image, true, "utexture2D",
     "image of the coarser level; unbound at the last level", surface_formats},
    second_coarse_surface,
    second_coarse_scattered,
    level_tiles,
    level_arguments,
    {"scattered", Usage::storage_image_write, false, "uimage2D", scattered_doc, surface_formats},
};
constexpr PassTypeSetting up_settings[] = {level_setting(1, "level that the pass writes"), variant, storage};

constexpr Port gather_ports[] = {
    {"light", Usage::sampled_image, false, "texture2D", "image of level 0", light_formats},
    {"surface", Usage::sampled_image, false, "utexture2D", "image of level 0", surface_formats},
    {"coarse_surface", Usage::sampled_image, false, "utexture2D", "image of level 1", surface_formats},
    {"coarse_scattered", Usage::sampled_image, false, "utexture2D", "image of level 1", surface_formats},
    level_tiles,
    level_arguments,
    {"scattered", Usage::storage_image_write, false, "image2D",
     "rgb: scattered light where there is subsurface, undefined elsewhere; a: confidence", light_formats},
};
constexpr PassTypeSetting gather_settings[] = {variant, storage};

constexpr Port half_gather_ports[] = {
    setup_ports[0],  port::material,  port::depth, port::scatter_scale, port::albedo,
    gather_ports[2], gather_ports[3], level_tiles, level_arguments,     gather_ports[6],
};

constexpr PassTypeSetting layered_gather_settings[] = {layered_variant, storage};

constexpr Port layered_down_ports[] = {
    down_ports[0],
    down_ports[1],
    {"second_light", Usage::sampled_image, true, "texture2D",
     "image of the second layer; unbound if the finer level has one layer", light_formats},
    {"second_surface", Usage::sampled_image, true, "utexture2D",
     "image of the second layer; unbound if the finer level has one layer", surface_formats},
    level_tiles,
    level_arguments,
    down_ports[4],
    down_ports[5],
    {"second_coarse_light", Usage::storage_image_write, false, "image2D", second_doc, light_formats},
    {"second_coarse_surface", Usage::storage_image_write, false, "uimage2D", second_doc, surface_formats},
};

constexpr Port layered_up_ports[] = {
    up_ports[0],
    up_ports[1],
    {"second_light", Usage::sampled_image, false, "texture2D", second_doc, light_formats},
    {"second_surface", Usage::sampled_image, false, "utexture2D", second_doc, surface_formats},
    up_ports[2],
    up_ports[3],
    second_coarse_surface,
    second_coarse_scattered,
    level_tiles,
    level_arguments,
    up_ports[8],
    {"second_scattered", Usage::storage_image_write, false, "uimage2D", second_doc, surface_formats},
};

constexpr Port layered_gather_ports[] = {
    gather_ports[0],
    gather_ports[1],
    gather_ports[2],
    gather_ports[3],
    {"second_coarse_surface", Usage::sampled_image, false, "utexture2D", second_doc, surface_formats},
    {"second_coarse_scattered", Usage::sampled_image, false, "utexture2D", second_doc, surface_formats},
    level_tiles,
    level_arguments,
    gather_ports[6],
};

} // namespace

const PassType sap_tiles_type{
    .name = "subsurface.sap_tiles",
    .shader = "sap/subsurface_sap_tiles",
    .doc = "Lists the tiles of every level of the surface-aware pyramid that can contain surface, and writes "
           "their indirect arguments, in one pass and in row order.",
    .ports = tiles_ports,
    .settings = {},
    .dispatch = single_group,
    .side_effects = false,
};

const PassType sap_setup_type{
    .name = "subsurface.sap_setup",
    .shader = "sap/subsurface_sap_setup",
    .doc = "Writes level 0 of the surface-aware pyramid: light and surface of every pixel of listed tiles.",
    .ports = setup_ports,
    .settings = setup_settings,
    .dispatch = over_tiles,
    .side_effects = false,
};

const PassType sap_down_type{
    .name = "subsurface.sap_down",
    .shader = "sap/subsurface_sap_down",
    .doc = "Reduces one level of the pyramid along the surface; stops at depth steps and other profiles.",
    .ports = down_ports,
    .settings = down_settings,
    .dispatch = over_tiles,
    .side_effects = false,
    .arguments_entry = "level",
};

const PassType sap_up_type{
    .name = "subsurface.sap_up",
    .shader = "sap/subsurface_sap_up",
    .doc = "Blends one level of the pyramid with the coarser levels; if these have two layers, a texel reads "
           "the layer nearer to its surface.",
    .ports = up_ports,
    .settings = up_settings,
    .dispatch = over_tiles,
    .side_effects = false,
    .arguments_entry = "level",
};

const PassType sap_gather_type{
    .name = "subsurface.sap_gather",
    .shader = "sap/subsurface_sap_gather",
    .doc = "Writes level 0 of the upward traversal: the scattered light of every listed pixel.",
    .ports = gather_ports,
    .settings = gather_settings,
    .dispatch = over_tiles,
    .side_effects = false,
};

const PassType sap_setup_half_res_type{
    .name = "subsurface.sap_setup_half_res",
    .shader = "sap/subsurface_sap_setup_half_res",
    .doc = "Writes level 1 of the surface-aware pyramid directly from the view: 2x2 pixels of one surface "
           "per texel. Replaces subsurface.sap_setup and the first subsurface.sap_down.",
    .ports = halve_ports,
    .settings = halve_settings,
    .dispatch = over_tiles,
    .side_effects = false,
    .arguments_entry = "level",
};

const PassType sap_gather_half_type{
    .name = "subsurface.sap_gather_half",
    .shader = "sap/subsurface_sap_gather_half",
    .doc = "Like subsurface.sap_gather, after subsurface.sap_setup_half_res: a pixel's own light at full "
           "resolution, light from other pixels at half resolution.",
    .ports = half_gather_ports,
    .settings = setup_settings,
    .dispatch = over_tiles,
    .side_effects = false,
};

const PassType sap_down_layered_type{
    .name = "subsurface.sap_down_layered",
    .shader = "sap/subsurface_sap_down_layered",
    .doc = "Like subsurface.sap_down, with a second layer per texel for surfaces apart from the first layer.",
    .ports = layered_down_ports,
    .settings = down_settings,
    .dispatch = over_tiles,
    .side_effects = false,
    .arguments_entry = "level",
};

const PassType sap_up_layered_type{
    .name = "subsurface.sap_up_layered",
    .shader = "sap/subsurface_sap_up_layered",
    .doc = "Like subsurface.sap_up, for both layers: each layer reads the nearer layer of other texels.",
    .ports = layered_up_ports,
    .settings = up_settings,
    .dispatch = over_tiles,
    .side_effects = false,
    .arguments_entry = "level",
};

const PassType sap_gather_layered_type{
    .name = "subsurface.sap_gather_layered",
    .shader = "sap/subsurface_sap_gather_layered",
    .doc = "Like subsurface.sap_gather, with two layers at level 1.",
    .ports = layered_gather_ports,
    .settings = layered_gather_settings,
    .dispatch = over_tiles,
    .side_effects = false,
};

} // namespace dermis::subsurface
