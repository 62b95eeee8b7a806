// Passes that prepare light for scattering and write it back.

#include "passes/common/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {

constexpr Port setup_ports[] = {
    port::lighting,
    port::material,
    port::depth,
    port::albedo,
    port::tiles,
    port::arguments,
    port::written(
        "light",
        "rgb: light that can scatter; a: area of the pixel's surface patch divided by its "
        "projected area; 0 outside",
        port::light_formats),
    port::optional(port::written(
        "slope", "change of depth from pixel to pixel divided by the pixel's size, in x and y",
        port::way_formats)),
};
constexpr PassTypeSetting texturing[] = {setting::texturing};

// An optional image of light of which each invocation reads only its own texel.
constexpr Port own_light(std::string_view name, std::string_view doc) {
  return port::optional(port::own_texels(port::sampled(name, doc, port::color_formats)));
}

constexpr std::string_view copied_options[] = {"unscattered", "scattered"};
constexpr Port combine_ports[] = {
    own_light(
        "scattered",
        "scattered light; unbound: no light scatters, and all light comes from 'unscattered'"),
    own_light(
        "unscattered",
        "diffuse irradiance before albedo, which copied tiles show. May be the image bound to "
        "'lighting'; 'scattered' or 'unscattered' must be bound"),
    port::material,
    port::albedo,
    port::tiles,
    port::arguments,
    port::combined,
};
constexpr std::string_view combined[] = {"scattered", "unscattered"};
constexpr PassTypeSetting combine_settings[] = {
    setting::texturing,
    setting::result,
    setting::choice("copied", copied_options,
                    "source of the light of copied tiles: unscattered (if bound) or scattered"),
};

constexpr Port copy_tiles_ports[] = {
    port::own_texels(port::lighting),
    port::albedo,
    port::tiles,
    port::arguments,
    port::updated("scattered", "written if no tile scatters; otherwise unchanged"),
};

constexpr Port combine_copies_ports[] = {
    port::own_texels(port::lighting),
    port::material,
    port::albedo,
    port::tiles,
    port::arguments,
    port::written(
        "lighting_out",
        "if no tile scatters, what subsurface.combine writes; otherwise unchanged. May be "
        "the image bound to 'lighting'",
        port::color_formats),
};
constexpr PassTypeSetting combine_copies_settings[] = {setting::texturing, setting::result};

constexpr Port export_scattered_ports[] = {
    port::own_texels(port::lighting),
    port::where_covered(own_light("scattered", "scattered light; unbound: no light scatters")),
    port::material,
    port::where_covered(port::depth),
    port::where_covered(port::scatter_scale),
    port::where_covered(port::albedo),
    port::optional(port::read_buffer("classes", "uint",
                                     "output of subsurface.classify: tiles that do not scatter "
                                     "keep their light. Unbound: 'scattered' "
                                     "holds the light of these tiles")),
    port::written(
        "light",
        "scattered light before albedo; the input light where nothing scatters, in full precision",
        port::color_formats),
};

constexpr PassTypeSetting export_settings[] = {
    setting::texturing,
    setting::boolean("leave_scattered",
                     "writes alpha 0 where light scatters, for a later pass that replaces these "
                     "texels ('scattered' is then not read)"),
};

constexpr Port back_lighting = port::sampled("back_lighting",
                                             "irradiance on the far side, linear, from the light "
                                             "along whose direction thickness is measured",
                                             port::color_formats);
constexpr Port thickness =
    port::sampled("thickness", "path length of that light through the material [m]");
constexpr Port transmission_stats_ports[] = {
    back_lighting, thickness, port::material, port::scatter_scale, port::tiles, port::arguments,
};
constexpr Port transmission_ports[] = {
    port::own_texels(port::lighting),
    port::where_covered(back_lighting),
    port::where_covered(thickness),
    port::material,
    port::where_covered(port::scatter_scale),
    port::where_covered(port::albedo),
    port::written("lit", "lighting plus transmitted light", port::color_formats),
};

} // namespace

const PassType setup_type{
    .name = "subsurface.setup",
    .shader = "common/subsurface_setup",
    .doc = "Extracts the light that can scatter: sanitised, premultiplied by the subsurface mask, "
           "rounded to "
           "nearest even.",
    .ports = setup_ports,
    .settings = texturing,
    .dispatch = over_tiles,
};

const PassType transmission_type{
    .name = "subsurface.transmission",
    .shader = "common/subsurface_transmission",
    .doc = "Adds light from the far side of thin parts: the fraction that the profile carries "
           "farther than "
           "their "
           "thickness.",
    .ports = transmission_ports,
    .settings = texturing,
    .dispatch = over_view,
};

const PassType transmission_stats_type{
    .name = "subsurface.transmission_stats",
    .shader = "common/subsurface_transmission_stats",
    .doc = "Measures the light transmitted through thin parts, which the choice uses to estimate "
           "the error "
           "of screen-space techniques.",
    .ports = transmission_stats_ports,
    .settings = {},
    .dispatch = over_tiles,
    .side_effects = true, // reports to the host
};

const PassType combine_type{
    .name = "subsurface.combine",
    .shader = "common/subsurface_combine",
    .doc = "Writes scattered light into the host's lighting. The host adds specular light.",
    .ports = combine_ports,
    .settings = combine_settings,
    .dispatch = over_tiles,
    .one_of = combined,
};

const PassType copy_tiles_type{
    .name = "subsurface.copy_tiles",
    .shader = "common/subsurface_copy_tiles",
    .doc = "Copies light unchanged if no tile of the screen scatters, for passes that need all "
           "tiles in one "
           "image.",
    .ports = copy_tiles_ports,
    .settings = texturing,
    .dispatch = over_tiles,
};

const PassType combine_copies_type{
    .name = "subsurface.combine_copies",
    .shader = "common/subsurface_combine_copies",
    .doc = "Writes unscattered light into the host's lighting if no tile of the screen scatters, "
           "after a pyramid whose last step does so otherwise.",
    .ports = combine_copies_ports,
    .settings = combine_copies_settings,
    .dispatch = over_tiles,
};

const PassType export_scattered_type{
    .name = "subsurface.export_scattered",
    .shader = "common/subsurface_export_scattered",
    .doc = "Exports scattered light before albedo for every pixel, for tools and for hosts that "
           "apply albedo "
           "later.",
    .ports = export_scattered_ports,
    .settings = export_settings,
    .dispatch = over_view,
};

} // namespace dermis::subsurface
