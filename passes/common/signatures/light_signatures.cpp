// Passes that prepare light for scattering and write it back.

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
     "rgb scatterable light, a = area of the pixel's surface patch over its projected area; 0 outside",
     port::light_formats},
    {"slope", Usage::storage_image_write, true, "image2D",
     "change of depth from pixel to pixel over the pixel's size, x and y", port::way_formats},
};
constexpr PassTypeSetting setup_settings[] = {setting::texturing};

constexpr std::string_view copied_options[] = {"unscattered", "scattered"};
constexpr Port combine_ports[] = {
    {"scattered", Usage::sampled_image, true, "texture2D",
     "scattered light; unbound: none scatters, all is as unscattered", port::color_formats, true},
    {"unscattered", Usage::sampled_image, true, "texture2D",
     "diffuse irradiance before albedo: what tiles show that are only copied. May be the image that is "
     "written; one of both is bound",
     port::color_formats, true},
    port::material,
    port::albedo,
    port::tiles,
    port::arguments,
    {"lighting", Usage::storage_image_write, false, "image2D",
     "written where there is subsurface, untouched elsewhere; alpha becomes 1 there", port::color_formats},
};
constexpr std::string_view combined[] = {"scattered", "unscattered"};
constexpr PassTypeSetting combine_settings[] = {
    setting::texturing,
    setting::choice(
        "result", result_options,
        "color: scattered light times albedo; light: scattered light alone, for hosts that texture later"),
    setting::choice("copied", copied_options,
                    "where the light of tiles comes from that are only copied: of unscattered, where it is "
                    "bound, or of scattered"),
};

constexpr Format scattered_formats[] = {Format::rgba16f}; // formats that a shader may load
constexpr Port copy_ports[] = {
    {"lighting", Usage::sampled_image, false, "texture2D", "diffuse irradiance before albedo, linear",
     port::color_formats, true},
    port::albedo,
    port::tiles,
    port::arguments,
    {"scattered", Usage::storage_image_update, false, "image2D",
     "written where no tile scatters, else left as it is", scattered_formats},
};
constexpr PassTypeSetting copy_settings[] = {setting::texturing};

constexpr Port light_ports[] = {
    {"lighting", Usage::sampled_image, false, "texture2D", "diffuse irradiance before albedo, linear",
     port::color_formats, true},
    {"scattered", Usage::sampled_image, true, "texture2D", "scattered light; unbound: nothing scatters",
     port::color_formats, true},
    port::material,
    port::depth,
    port::scatter_scale,
    port::albedo,
    {"classes",
     Usage::storage_buffer_read,
     true,
     "uint",
     "as subsurface.classify writes them: tiles that do not scatter keep their light. Unbound: their light "
     "is in scattered",
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
    "irradiance on the far side, linear, of the light that thickness is measured along",
    port::color_formats};
constexpr Port thickness_port{
    "thickness", Usage::sampled_image, false, "texture2D", "way of that light through the material, metres",
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
    {"lit", Usage::storage_image_write, false, "image2D", "lighting with what came through",
     port::color_formats},
};

} // namespace

const PassType setup_type{
    .name = "subsurface.setup",
    .shader = "common/subsurface_setup",
    .doc = "Takes the light that can scatter: sanitised, premultiplied by the subsurface mask, rounded to "
           "nearest even.",
    .ports = setup_ports,
    .settings = setup_settings,
    .dispatch = DispatchShape::over_tiles,
    .side_effects = false,
};

const PassType transmission_type{
    .name = "subsurface.transmission",
    .shader = "common/subsurface_transmission",
    .doc =
        "Adds light from the far side of thin parts: the share that the profile carries further than their "
        "thickness.",
    .ports = transmission_ports,
    .settings = {},
    .dispatch = DispatchShape::over_view,
    .side_effects = false,
};

const PassType transmission_stats_type{
    .name = "subsurface.transmission_stats",
    .shader = "common/subsurface_transmission_stats",
    .doc = "Counts the light that comes through thin parts, so that the choice knows what screen space does "
           "not see.",
    .ports = thin_parts_ports,
    .settings = {},
    .dispatch = DispatchShape::over_tiles,
    .side_effects = true, // reports to the host
};

const PassType combine_type{
    .name = "subsurface.combine",
    .shader = "common/subsurface_combine",
    .doc = "Puts scattered light back into the host's lighting. Specular stays with the host.",
    .ports = combine_ports,
    .settings = combine_settings,
    .dispatch = DispatchShape::over_tiles,
    .side_effects = false,
    .one_of = combined,
};

const PassType copy_tiles_type{
    .name = "subsurface.copy_tiles",
    .shader = "common/subsurface_copy_tiles",
    .doc =
        "Passes light on as it is, where no tile of the screen scatters, for passes that want all tiles in "
        "one picture.",
    .ports = copy_ports,
    .settings = copy_settings,
    .dispatch = DispatchShape::over_tiles,
    .side_effects = false,
};

const PassType export_scattered_type{
    .name = "subsurface.export_scattered",
    .shader = "common/subsurface_export_scattered",
    .doc = "Hands out scattered light before albedo for every pixel, for tools and hosts that texture later.",
    .ports = light_ports,
    .settings = light_settings,
    .dispatch = DispatchShape::over_view,
    .side_effects = false,
};

} // namespace dermis::subsurface
