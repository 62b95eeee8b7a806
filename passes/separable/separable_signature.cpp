// The separable kernel: setup, then one pass per axis.

#include "passes/common/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {

constexpr std::string_view axis_options[] = {"horizontal", "vertical"};
constexpr std::string_view taps_options[] = {"11", "17", "25"};
constexpr std::string_view kernel_options[] = {"fitted", "jimenez"};
constexpr Format view_depth_formats[] = {Format::r32f};
constexpr std::string_view light_doc = "rgb: light that can scatter; a: profile id";
constexpr std::string_view view_depth_doc =
    "view depth in mm; infinite where no subsurface is visible";

constexpr Port separable_ports[] = {
    port::sampled("light", "output of subsurface.separable_setup", port::light_formats),
    port::optional(port::sampled("blurred",
                                 "result of the horizontal pass; bound for the vertical pass",
                                 port::light_formats)),
    port::sampled("view_depth", "output of subsurface.separable_setup", view_depth_formats),
    port::scatter_scale,
    port::tiles,
    port::arguments,
    port::written("scattered",
                  "scattered light where there is subsurface, undefined elsewhere; a: profile id "
                  "after the horizontal pass, 1 after the vertical pass",
                  port::color_formats),
};
constexpr PassTypeSetting separable_settings[] = {
    setting::choice("axis", axis_options,
                    "axis of this pass; a graph runs the horizontal pass, then the vertical pass"),
    setting::choice("taps", taps_options, "number of reads along the axis", 1, "taps"),
    setting::choice(
        "kernel", kernel_options,
        "fitted: kernel fitted to each profile for each projected d; jimenez: the published "
        "artist-friendly kernel"),
};

constexpr Port separable_selected_ports[] = {
    port::lighting,
    port::material,
    port::depth,
    port::scatter_scale,
    port::albedo,
    port::optional(port::sampled("blurred",
                                 "result of the horizontal pass; bound for the vertical pass",
                                 port::light_formats)),
    port::tile_states,
    port::velocity,
    port::states_before,
    port::pixel_weights_before,
    port::tiles,
    port::arguments,
    port::written("scattered",
                  "scattered light of the listed tiles, undefined elsewhere; a: profile id after "
                  "the horizontal pass, 1 after the vertical pass",
                  port::color_formats),
    port::optional(port::pixel_weights),
};
constexpr PassTypeSetting separable_selected_settings[] = {
    separable_settings[0],
    separable_settings[1],
    setting::texturing,
};

constexpr Port setup_ports[] = {
    port::where_covered(port::lighting),
    port::where_covered(port::material),
    port::where_covered(port::depth),
    port::where_covered(port::albedo),
    port::classes,
    port::where_covered(port::written("light", light_doc, port::light_formats)),
    port::written("view_depth", view_depth_doc, view_depth_formats),
};
constexpr PassTypeSetting setup_settings[] = {setting::texturing};

constexpr std::string_view needed_doc = "1 per tile that the vertical pass reads; cleared before";
constexpr Port separable_tiles_ports[] = {
    port::classes,
    port::samples_per_tile,
    port::tile_d,
    {"needed", Usage::storage_buffer_update, false, "uint", needed_doc},
    port::list_state,
    port::written_buffer("vertical_tiles", "uint", "tiles of the vertical pass"),
    port::written_buffer("vertical_arguments", "uint", "group counts of the vertical pass"),
    port::written_buffer("horizontal_tiles", "uint", "tiles of the horizontal pass"),
    port::written_buffer("horizontal_arguments", "uint", "group counts of the horizontal pass"),
};
constexpr PassTypeSetting separable_tiles_settings[] = {
    setting::choice("taps", taps_options, "number of reads along each axis", 1, "taps")};

} // namespace

const PassType separable_tiles_type{
    .name = "subsurface.separable_tiles",
    .shader = "separable/subsurface_separable_tiles",
    .doc = "Lists the tiles of both passes of subsurface.separable: tiles without samples of "
           "another technique, tiles where samples fade out, and tiles that these read.",
    .ports = separable_tiles_ports,
    .settings = separable_tiles_settings,
    .dispatch = over_tile_grid,
};

const PassType separable_setup_type{
    .name = "subsurface.separable_setup",
    .shader = "separable/subsurface_separable_setup",
    .doc = "Writes light and view depth for subsurface.separable.",
    .ports = setup_ports,
    .settings = setup_settings,
    .dispatch = over_view,
};

const PassType separable_type{
    .name = "subsurface.separable",
    .shader = "separable/subsurface_separable",
    .doc = "Applies one 1-D pass of a separable kernel: delta plus rank 1, fitted to the profile, "
           "or the "
           "published kernel.",
    .ports = separable_ports,
    .settings = separable_settings,
    .dispatch = over_tiles,
};

const PassType separable_selected_type{
    .name = "subsurface.separable_selected",
    .shader = "separable/subsurface_separable_selected",
    .doc = "Applies one 1-D pass of the fitted separable kernel to the tiles that "
           "subsurface.select_tiles selected, directly from the host's images.",
    .ports = separable_selected_ports,
    .settings = separable_selected_settings,
    .dispatch = over_tiles,
};

} // namespace dermis::subsurface
