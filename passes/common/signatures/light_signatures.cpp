// Passes that prepare light for scattering and write it back.

#include "passes/common/dispatch.hpp"
#include "passes/common/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {

constexpr std::string_view result_options[] = {"color", "light"};

constexpr Port setup_ports[] = {
    {"lighting", Usage::sampled_image, false, "texture2D", "diffuse irradiance before albedo, linear",
     port::color_formats},
    port::material,
    port::depth,
    port::albedo,
    port::tiles,
    port::arguments,
    {"light", Usage::storage_image_write, false, "image2D",
     "rgb: light that can scatter; a: area of the pixel's surface patch divided by its projected area; 0 "
     "outside",
     port::light_formats},
    {"slope", Usage::storage_image_write, true, "image2D",
     "change of depth from pixel to pixel divided by the pixel's size, in x and y", port::way_formats},
};
constexpr PassTypeSetting setup_settings[] = {setting::texturing};

constexpr std::string_view copied_options[] = {"unscattered", "scattered"};
constexpr Port combine_ports[] = {
    {"scattered", Usage::sampled_image, true, "texture2D",
     "scattered light; unbound: no light scatters, and all light comes from 'unscattered'",
     port::color_formats, true},
    {"unscattered", Usage::sampled_image, true, "texture2D",
     "diffuse irradiance before albedo, which copied tiles show. May be the image bound to 'lighting'; "
     "'scattered' or 'unscattered' must be bound",
     port::color_formats, true},
    port::material,
    port::albedo,
    port::tiles,
    port::arguments,
    {"lighting", Usage::storage_image_write, false, "image2D",
     "written where there is subsurface, with alpha 1; unchanged elsewhere", port::color_formats},
};
constexpr std::string_view combined[] = {"scattered", "unscattered"};
constexpr PassTypeSetting combine_settings[] = {
    setting::texturing,
    setting::choice("result", result_options,
                    "color: scattered light times albedo; light: only scattered light, for hosts that apply "
                    "albedo later"),
    setting::choice("copied", copied_options,
                    "source of the light of copied tiles: unscattered (if bound) or scattered"),
};

constexpr Format scattered_formats[] = {Format::rgba16f}; // formats that a shader may load
constexpr Port copy_ports[] = {
    {"lighting", Usage::sampled_image, false, "texture2D", "diffuse irradiance before albedo, linear",
     port::color_formats, true},
    port::albedo,
    port::tiles,
    port::arguments,
    {"scattered", Usage::storage_image_update, false, "image2D",
     "written if no tile scatters; otherwise unchanged", scattered_formats},
};
constexpr PassTypeSetting copy_settings[] = {setting::texturing};

constexpr Port light_ports[] = {
    {"lighting", Usage::sampled_image, false, "texture2D", "diffuse irradiance before albedo, linear",
     port::color_formats, true},
    {"scattered", Usage::sampled_image, true, "texture2D", "scattered light; unbound: no light scatters",
     port::color_formats, true},
    port::material,
    port::depth,
    port::scatter_scale,
    port::albedo,
    {"classes",
     Usage::storage_buffer_read,
     true,
     "uint",
     "output of subsurface.classify: tiles that do not scatter keep their light. Unbound: 'scattered' holds "
     "the light of these tiles",
     {}},
    {"light", Usage::storage_image_write, false, "image2D",
     "scattered light before albedo; the input light where nothing scatters, in full precision",
     port::color_formats},
};
constexpr PassTypeSetting light_settings[] = {setting::texturing};

constexpr Port back_lighting_port{
    "back_lighting",
    Usage::sampled_image,
    false,
    "texture2D",
    "irradiance on the far side, linear, from the light along whose direction thickness is measured",
    port::color_formats};
constexpr Port thickness_port{"thickness",
                              Usage::sampled_image,
                              false,
                              "texture2D",
                              "path length of that light through the material [m]",
                              {}};
constexpr Port thin_parts_ports[] = {
    back_lighting_port, thickness_port, port::material, port::scatter_scale, port::tiles, port::arguments,
};
constexpr Port transmission_ports[] = {
    {"lighting", Usage::sampled_image, false, "texture2D", "diffuse irradiance before albedo, linear",
     port::color_formats, true},
    back_lighting_port,
    thickness_port,
    port::material,
    port::scatter_scale,
    {"lit", Usage::storage_image_write, false, "image2D", "lighting plus transmitted light",
     port::color_formats},
};

} // namespace

const PassType setup_type{
    .name = "subsurface.setup",
    .shader = "common/subsurface_setup",
    .doc = "Extracts the light that can scatter: sanitised, premultiplied by the subsurface mask, rounded to "
           "nearest even.",
    .ports = setup_ports,
    .settings = setup_settings,
    .dispatch = over_tiles,
    .side_effects = false,
};

const PassType transmission_type{
    .name = "subsurface.transmission",
    .shader = "common/subsurface_transmission",
    .doc = "Adds light from the far side of thin parts: the fraction that the profile carries farther than "
           "their "
           "thickness.",
    .ports = transmission_ports,
    .settings = {},
    .dispatch = over_view,
    .side_effects = false,
};

const PassType transmission_stats_type{
    .name = "subsurface.transmission_stats",
    .shader = "common/subsurface_transmission_stats",
    .doc = "Measures the light transmitted through thin parts, which the choice uses to estimate the error "
           "of screen-space techniques.",
    .ports = thin_parts_ports,
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
    .side_effects = false,
    .one_of = combined,
};

const PassType copy_tiles_type{
    .name = "subsurface.copy_tiles",
    .shader = "common/subsurface_copy_tiles",
    .doc = "Copies light unchanged if no tile of the screen scatters, for passes that need all tiles in one "
           "image.",
    .ports = copy_ports,
    .settings = copy_settings,
    .dispatch = over_tiles,
    .side_effects = false,
};

const PassType export_scattered_type{
    .name = "subsurface.export_scattered",
    .shader = "common/subsurface_export_scattered",
    .doc = "Exports scattered light before albedo for every pixel, for tools and for hosts that apply albedo "
           "later.",
    .ports = light_ports,
    .settings = light_settings,
    .dispatch = over_view,
    .side_effects = false,
};

} // namespace dermis::subsurface
