// The surface-aware pyramid: one pass type per step, one pass per level. Level 0 is the view. Level
// l has a texel every 2^l pixels and a border of one texel, which covers what lies beyond the last
// pixels.

#include "passes/common/signatures/signatures.hpp"
#include "passes/sap/sap_weights.hpp"

namespace dermis::subsurface {

namespace {

// names of the first SapVariants
constexpr std::string_view variant_options[] = {"base", "smooth", "half"};

constexpr std::string_view light_doc =
    "r, g of the light (the other channels are in the image of the surface); in full storage rgb: "
    "light, a: fourth root of the surface's area divided by its cross-section";
constexpr std::string_view surface_doc =
    "depth in mm (float; sign: a second layer exists, or level 0 is next to another surface; last "
    "7 bits: fraction of the surface under "
    "the texel that its layers represent); slope x, y (halves; last 4 bits of x: fraction of the "
    "surface whose profile has no layer); then bit by bit: b of the light (half), fourth root of "
    "the surface's area divided by its cross-section (10 bits), 0 (6 bits), fraction of the "
    "texel's kernel on its own surface (11 bits), factor on d (13 bits), profile id (8 bits; 0: no "
    "surface)";
constexpr std::string_view scattered_doc =
    "scattered light of this level and coarser levels (3 halves), confidence (half), fraction of "
    "the kernel "
    "on the surface (3 halves), 0; in full storage: light (bits of 3 floats), the fraction and the "
    "confidence (a byte each)";

using port::light_formats;
using port::sap_light_formats;
using port::surface_formats;

constexpr PassTypeSetting written_level(double last = sap_level_count - 1) {
  return setting::integer("level", 1, 1, last, "", "level that the pass writes");
}

constexpr PassTypeSetting variant = setting::choice(
    "variant", variant_options,
    "tent filter. base: at levels 0 and 1; smooth: at every level, which hides the grid; "
    "half: at level 1, below subsurface.sap_gather_half",
    1);

constexpr std::string_view storage_options[] = {"half", "full"};
constexpr PassTypeSetting storage = setting::choice(
    "storage", storage_options,
    "precision of written light. half: half floats; full: floats, whose images need 32 bits "
    "per channel. All passes of a pyramid must use the same value");

constexpr Port level_tiles =
    port::read_buffer("level_tiles", "uvec2", "output of subsurface.sap_tiles");
constexpr Port level_arguments{"level_arguments", Usage::indirect_arguments, false, "uint",
                               "output of subsurface.sap_tiles"};

constexpr Port tiles_ports[] = {
    port::classes,
    port::list_state,
    port::where_covered(port::written_buffer("level_tiles", "uvec2",
                                             "for each level, the index of its first entry and the "
                                             "number of entries; then the entries, with space for "
                                             "all tiles of each level: tile x in "
                                             "bits 0-14, y in bits 15-29, bit 30: all pixels have "
                                             "subsurface, bit 31: copy only; then a mask of "
                                             "the 3x3 tiles that can contain surface: bits 0-8 for "
                                             "the tiles of the finer level that the tile "
                                             "reduces, bits 9-17 for the tiles around it")),
    port::written_buffer("level_arguments", "uint",
                         "for each level, the group counts x, y, z of an indirect dispatch over "
                         "its tiles, and x times y"),
    port::where_covered(port::writer_of(port::tiles)),
    port::writer_of(port::arguments),
    port::optional(port::written_buffer(
        "copy_arguments", "uint",
        "like 'arguments', but 0 groups if any tile scatters, because the pyramid then also copies "
        "the other "
        "tiles. If the port is bound, the pyramid's lists are empty when no tile scatters")),
};

// Limits the formats of light in full storage.
constexpr Port as_stored(Port light) {
  light.formats_while = {"storage", 1, port::sap_full_light_formats};
  return light;
}
constexpr Port written_light(std::string_view name, std::string_view doc = light_doc) {
  return as_stored(port::written(name, doc, sap_light_formats));
}
constexpr Port written_surface(std::string_view name, std::string_view doc = surface_doc) {
  return port::written_uint(name, doc, surface_formats);
}
constexpr Port read_light(std::string_view name, std::string_view doc) {
  return as_stored(port::sampled(name, doc, sap_light_formats));
}
constexpr Port read_surface(std::string_view name, std::string_view doc) {
  return port::sampled_uint(name, doc, surface_formats);
}

// Ports that read the view, and the tiles of a level.
constexpr std::array view{port::lighting, port::material, port::depth, port::scatter_scale,
                          port::albedo};
constexpr std::array level{port::with_bytes_per_tile(level_tiles, 8), level_arguments};

constexpr auto setup_ports =
    join(view, level, std::array{written_light("light"), written_surface("surface")});
constexpr PassTypeSetting setup_settings[] = {setting::texturing, storage};

// Results of a step down.
constexpr std::array coarse{written_light("coarse_light"), written_surface("coarse_surface")};

constexpr auto setup_half_res_ports = join(view, level, coarse);
constexpr PassTypeSetting setup_half_res_settings[] = {written_level(1), setting::texturing,
                                                       storage};

constexpr std::array finer{read_light("light", "image of the finer level"),
                           read_surface("surface", "image of the finer level")};
constexpr PassTypeSetting down_settings[] = {written_level(), storage};

// Ports of the second layer, for levels whose texels can have a second surface. Its images are
// valid only at texels whose first surface has the flag.
constexpr std::string_view second_doc =
    "image of the second layer, which holds surfaces apart from the "
    "first layer; undefined where a texel has only one layer";
constexpr Port second_coarse_surface =
    port::where_flagged(read_surface("second_coarse_surface", second_doc));
constexpr Port second_coarse_scattered =
    port::where_flagged(read_surface("second_coarse_scattered", second_doc));

constexpr std::array this_level{read_light("light", "image of this level"),
                                read_surface("surface", "image of this level")};
constexpr std::string_view coarser_doc = "image of the coarser level; unbound at the last level";
constexpr std::array coarser{port::optional(read_surface("coarse_surface", coarser_doc)),
                             port::optional(read_surface("coarse_scattered", coarser_doc))};
constexpr std::array second_coarser{port::optional(second_coarse_surface),
                                    port::optional(second_coarse_scattered)};
constexpr std::array up_result{written_surface("scattered", scattered_doc)};
constexpr PassTypeSetting up_settings[] = {written_level(), variant, storage};

constexpr std::array level_0{read_light("light", "image of level 0"),
                             read_surface("surface", "image of level 0")};
constexpr std::array level_1{read_surface("coarse_surface", "image of level 1"),
                             read_surface("coarse_scattered", "image of level 1")};
constexpr Port written_scattered = port::written(
    "scattered",
    "rgb: scattered light where there is subsurface, undefined elsewhere; a: confidence",
    light_formats);
// The last step writes scattered light for other passes, or the work of subsurface.combine and
// subsurface.export_scattered.
constexpr std::array last_inputs{
    port::albedo, port::optional(port::own_texels(port::sampled(
                      "unscattered",
                      "output of subsurface.export_scattered with leave_scattered; the image "
                      "bound to 'scattered_light'",
                      light_formats)))};
constexpr std::array last_results{
    port::optional(written_scattered), port::optional(port::combined),
    port::optional(port::written(
        "scattered_light",
        "scattered light before albedo where 'unscattered' has alpha 0; unchanged elsewhere",
        light_formats))};
constexpr std::string_view last_one_of[] = {"scattered", "lighting"};
constexpr auto gather_ports =
    join(level_0, level_1, second_coarser, level, last_inputs, last_results);
constexpr PassTypeSetting gather_settings[] = {variant, storage, setting::texturing,
                                               setting::result};

constexpr auto gather_probed_ports =
    join(port::at_few_texels(join(level_0, level_1, second_coarser)), std::array{port::classes},
         port::at_few_texels(std::array{written_scattered}));
constexpr PassTypeSetting gather_probed_settings[] = {variant, storage, setting::probed_tiles,
                                                      setting::probe_interval};

constexpr auto half_gather_ports = join(view, level_1, level, std::array{written_scattered});

// Second layer of the finer level on the way down, and of the own level on the way up.
constexpr std::string_view second_input_doc =
    "image of the second layer; unbound if the level has one layer";
constexpr std::array second_input{
    port::optional(port::where_flagged(read_light("second_light", second_input_doc))),
    port::optional(port::where_flagged(read_surface("second_surface", second_input_doc)))};
constexpr auto down_ports = join(
    finer, second_input, level, coarse,
    std::array{
        port::where_flagged(port::optional(written_light("second_coarse_light", second_doc))),
        port::where_flagged(port::optional(written_surface("second_coarse_surface", second_doc)))});

constexpr Port second_scattered =
    port::where_flagged(written_surface("second_scattered", second_doc));
constexpr auto up_ports = join(this_level, second_input, coarser, second_coarser, level, up_result,
                               std::array{port::optional(second_scattered)});

// Several levels in one dispatch.
constexpr Format bits_formats[] = {Format::rgba32_uint};
constexpr int first_of_levels = 5; // level; needs.cpp has the size of `computed_children`
constexpr std::string_view levels_doc =
    "levels from the first one on in array layers, four per level: surface, second surface, light, "
    "second light. Light is stored as bits: 4 halves in 2 words, or 4 floats in full storage";
constexpr std::array several_levels{level_tiles, level_arguments};
constexpr auto coarse_down_ports =
    join(finer, second_input, several_levels,
         std::array{port::internally_ordered(Port{.name = "levels",
                                                  .usage = Usage::storage_image_write,
                                                  .glsl_type = "uimage2DArray",
                                                  .doc = levels_doc,
                                                  .formats = bits_formats}),
                    port::optional(written_light("level_light", "light of the first level")),
                    Port{.name = "computed_children",
                         .usage = Usage::storage_buffer_update,
                         .glsl_type = "uint",
                         .doc = "0 before the pass; per tile of the second level and coarser "
                                "levels: number of computed tiles of the finer level"}});
constexpr PassTypeSetting coarse_down_settings[] = {
    setting::integer("level", first_of_levels, first_of_levels, sap_level_count - 1, "",
                     "first level that the pass writes"),
    storage};

constexpr auto coarse_up_ports =
    join(this_level,
         std::array{port::where_flagged(read_light("second_light", second_doc)),
                    port::where_flagged(read_surface("second_surface", second_doc))},
         std::array{Port{.name = "levels",
                         .usage = Usage::sampled_image,
                         .glsl_type = "utexture2DArray",
                         .doc = "output of subsurface.sap_coarse_down from the next level on",
                         .formats = bits_formats}},
         several_levels, up_result, std::array{second_scattered});
constexpr PassTypeSetting coarse_up_settings[] = {
    setting::integer("level", first_of_levels - 1, first_of_levels - 1, sap_level_count - 2, "",
                     "level that the pass writes"),
    variant, storage};

} // namespace

const PassType sap_tiles_type{
    .name = "subsurface.sap_tiles",
    .shader = "sap/subsurface_sap_tiles",
    .doc = "Lists the tiles of every level of the surface-aware pyramid that can contain surface, "
           "and writes their indirect arguments. The order of a list varies.",
    .ports = tiles_ports,
    .settings = {},
    .dispatch = over_tile_regions,
};

const PassType sap_setup_type{
    .name = "subsurface.sap_setup",
    .shader = "sap/subsurface_sap_setup",
    .doc = "Writes level 0 of the surface-aware pyramid: light and surface of every pixel of "
           "listed tiles.",
    .ports = setup_ports,
    .settings = setup_settings,
    .dispatch = over_tiles,
};

const PassType sap_gather_type{
    .name = "subsurface.sap_gather",
    .shader = "sap/subsurface_sap_gather",
    .doc = "Writes level 0 of the upward traversal: the scattered light of every listed pixel, or "
           "directly the host's lighting.",
    .ports = gather_ports,
    .settings = gather_settings,
    .dispatch = over_tiles,
    .one_of = last_one_of,
};

const PassType sap_gather_probed_type{
    .name = "subsurface.sap_gather_probed",
    .shader = "sap/subsurface_sap_gather_probed",
    .doc = "Like subsurface.sap_gather, but only in the tiles that subsurface.probe with equal "
           "settings selects. Elsewhere 'scattered' is undefined.",
    .ports = gather_probed_ports,
    .settings = gather_probed_settings,
    .dispatch = over_probed_tiles(64),
};

const PassType sap_setup_half_res_type{
    .name = "subsurface.sap_setup_half_res",
    .shader = "sap/subsurface_sap_setup_half_res",
    .doc = "Writes level 1 of the surface-aware pyramid directly from the view: 2x2 pixels of one "
           "surface "
           "per texel. Replaces subsurface.sap_setup and the first subsurface.sap_down.",
    .ports = setup_half_res_ports,
    .settings = setup_half_res_settings,
    .dispatch = over_tiles,
    .arguments_entry = "level",
};

const PassType sap_gather_half_type{
    .name = "subsurface.sap_gather_half",
    .shader = "sap/subsurface_sap_gather_half",
    .doc = "Like subsurface.sap_gather, after subsurface.sap_setup_half_res: a pixel's own light "
           "at full "
           "resolution, light from other pixels at half resolution.",
    .ports = half_gather_ports,
    .settings = setup_settings,
    .dispatch = over_tiles,
};

const PassType sap_down_type{
    .name = "subsurface.sap_down",
    .shader = "sap/subsurface_sap_down",
    .doc = "Reduces one level of the pyramid along the surface. A second layer per texel holds "
           "surfaces "
           "apart from the first layer, such as other profiles; at level 1 only next to pixels "
           "that subsurface.sap_setup marks.",
    .ports = down_ports,
    .settings = down_settings,
    .dispatch = over_tiles,
    .arguments_entry = "level",
};

const PassType sap_up_type{
    .name = "subsurface.sap_up",
    .shader = "sap/subsurface_sap_up",
    .doc =
        "Blends one level of the pyramid with the coarser levels: each of a texel's layers reads "
        "the nearer layer of other texels.",
    .ports = up_ports,
    .settings = up_settings,
    .dispatch = over_tiles,
    .arguments_entry = "level",
};

const PassType sap_coarse_down_type{
    .name = "subsurface.sap_coarse_down",
    .shader = "sap/subsurface_sap_coarse_down",
    .doc = "Like subsurface.sap_down, for all levels from one level on in one dispatch: a "
           "group computes a tile of the first level, and a tile of the next level if it computed "
           "the last of its children.",
    .ports = coarse_down_ports,
    .settings = coarse_down_settings,
    .dispatch = over_tiles,
    .arguments_entry = "level",
};

const PassType sap_coarse_up_type{
    .name = "subsurface.sap_coarse_up",
    .shader = "sap/subsurface_sap_coarse_up",
    .doc =
        "Like subsurface.sap_up, for one level and all coarser levels in one dispatch: a "
        "group also computes the texels of the coarser levels that its tile needs. These are not "
        "written.",
    .ports = coarse_up_ports,
    .settings = coarse_up_settings,
    .dispatch = over_tiles,
    .arguments_entry = "level",
};

} // namespace dermis::subsurface
