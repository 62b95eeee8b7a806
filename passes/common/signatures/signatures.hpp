#pragma once
// One signature per kernel; pass_types.cpp lists them. Grouped by purpose: tiles, light in and out,
// scattering. The comment above a declaration names its file.

#include "framegraph/model/pass_type.hpp"

namespace dermis::subsurface {

// tile_signatures.cpp
extern const PassType classify_type, classify_uniform_light_type, tile_list_type, debug_tile_class_type;
// light_signatures.cpp
extern const PassType setup_type, combine_type, export_scattered_type, copy_tiles_type, transmission_type,
    transmission_stats_type;
// burley/burley_signature.cpp
extern const PassType burley_type;
// separable/separable_signature.cpp
extern const PassType separable_type;
// papers/fixed_signature.cpp
extern const PassType fixed_type;
// afis/afis_signatures.cpp
extern const PassType afis_type, guided_type, afis_tiles_type;
// afis/pyramid_signatures.cpp
extern const PassType pyramid_setup_type, pyramid_down_type;
// papers/pyramid_gather_signature.cpp
extern const PassType pyramid_gather_type;
// sap/sap_signatures.cpp
extern const PassType sap_tiles_type, sap_setup_type, sap_down_type, sap_up_type, sap_gather_type,
    sap_down_layered_type, sap_up_layered_type, sap_gather_layered_type, sap_setup_half_res_type,
    sap_gather_half_type;
// papers/residual_signatures.cpp
extern const PassType refine_type, global_light_change_type, residual_type;
// sap/sample_signatures.cpp
extern const PassType tile_error_estimate_type, allocate_samples_type, tile_refine_type;
// papers/tile_variance_signature.cpp
extern const PassType tile_variance_type;
// probe_signature.cpp
extern const PassType probe_type;
// accumulate_signature.cpp
extern const PassType accumulate_type;
// clear_signature.cpp
extern const PassType clear_type;
// restir/restir_signatures.cpp
extern const PassType restir_initial_type, restir_temporal_type, restir_spatial_type, restir_resolve_type;

// Ports that several pass types declare with the same meaning.
namespace port {
// Allowed formats, by the channels that kernels read and write.
// Three channels.
inline constexpr Format color_formats[] = {Format::rgba16f, Format::rgba32f, Format::b10g11r11f,
                                           Format::rgba8_unorm, Format::rgba8_srgb};
// Four channels, with areas above 1.
inline constexpr Format light_formats[] = {Format::rgba16f, Format::rgba32f};
// Two channels, with negative values.
inline constexpr Format way_formats[] = {Format::rg16f, Format::rg32f, Format::rgba16f, Format::rgba32f};
inline constexpr Port material{
    "material", Usage::sampled_image, false, "utexture2D", "profile id per pixel; 0: no subsurface", {}};
inline constexpr Port depth{"depth",
                            Usage::sampled_image,
                            false,
                            "texture2D",
                            "device depth or view-space distance, as stated in dermis_frame.depth_kind",
                            {}};
inline constexpr Port scatter_scale{"scatter_scale",
                                    Usage::sampled_image,
                                    true,
                                    "texture2D",
                                    "factor on d per pixel; 0: diffuse; unbound: 1",
                                    {}};
inline constexpr Port albedo{
    "albedo", Usage::sampled_image, true, "texture2D", "diffuse albedo, linear; unbound: 1", color_formats};
inline constexpr Port tiles{"tiles",
                            Usage::storage_buffer_read,
                            false,
                            "uint",
                            "element 0: number of tiles; then packed tiles: x in bits 0-14, y in bits 15-29, "
                            "bit 30: all pixels have subsurface, bit 31: copy only",
                            {}};
inline constexpr Port arguments{"arguments",
                                Usage::indirect_arguments,
                                false,
                                "uint",
                                "group counts x, y, z of an indirect dispatch over the tiles",
                                {}};
inline constexpr Port scattered{"scattered",
                                Usage::storage_image_write,
                                false,
                                "image2D",
                                "scattered light where there is subsurface; undefined elsewhere",
                                color_formats};
inline constexpr std::string_view level_doc =
    "rgb: light times mask; a: mask, the fraction of the texel with subsurface";
// Returns a port that reads a level of the plain pyramid.
constexpr Port level_port(std::string_view name) {
  return {name, Usage::sampled_image, false, "texture2D", level_doc, light_formats};
}
inline constexpr Port velocity{
    "velocity",
    Usage::sampled_image,
    true,
    "texture2D",
    "current minus previous position in pixels (right, down), without jitter; optional third channel: change "
    "of view depth that camera motion does not explain, in world units. Unbound: the scene is static",
    way_formats};
inline constexpr Port classes{"classes", Usage::storage_buffer_read,      false,
                              "uint",    "output of subsurface.classify", {}};
inline constexpr Port samples_per_tile{"samples_per_tile",
                                       Usage::storage_buffer_read,
                                       false,
                                       "uint",
                                       "per tile of the render rectangle: allocated sample steps, 0 to 3",
                                       {}};
// GLSL type of an image that is cleared in the same frame and written where there is subsurface:
// texels that were not written read 0 in the next frame.
inline constexpr std::string_view part_of_cleared = "writeonly image2D";
inline constexpr Port sampling{
    "sampling",
    Usage::storage_image_write,
    true,
    "image2D",
    "for tools: samples of this frame; samples in the history or their mean number; confidence or standard "
    "deviation; 1 where the history belongs to another surface",
    light_formats};
inline constexpr Port light{"light",     Usage::sampled_image,         false,
                            "texture2D", "output of subsurface.setup", port::light_formats};
inline constexpr Port slope{"slope",     Usage::sampled_image,         false,
                            "texture2D", "output of subsurface.setup", port::way_formats};
inline constexpr Port burley_ports[] = {
    light,       slope,           port::material,  port::depth, port::scatter_scale,
    port::tiles, port::arguments, port::scattered,
};
inline constexpr Format importance_formats[] = {Format::r8_unorm, Format::r16f, Format::r32f};
inline constexpr std::string_view tile_errors_doc =
    "per tile of the render rectangle: expected error; 0: no error";
} // namespace port

constexpr SettingValue integer_value(int64_t value) {
  return {SettingType::integer, value, 0.0};
}
constexpr SettingValue option_value(int64_t index) {
  return {SettingType::enumeration, index, 0.0};
}

namespace setting {
// Declares a choice among `options`; options[standard] is the default.
constexpr PassTypeSetting choice(std::string_view name, std::span<const std::string_view> options,
                                 std::string_view doc, int64_t standard = 0) {
  return {.name = name,
          .type = SettingType::enumeration,
          .default_value = option_value(standard),
          .minimum = 0,
          .maximum = 0,
          .options = options,
          .unit = "",
          .doc = doc};
}

constexpr PassTypeSetting real(std::string_view name, double standard, double minimum, double maximum,
                               std::string_view unit, std::string_view doc) {
  return {.name = name,
          .type = SettingType::real,
          .default_value = {SettingType::real, 0, standard},
          .minimum = minimum,
          .maximum = maximum,
          .options = {},
          .unit = unit,
          .doc = doc};
}

// Allows a value per view, which may change every frame.
constexpr PassTypeSetting per_frame(PassTypeSetting setting) {
  setting.per_frame = true;
  return setting;
}

// Settings that several pass types declare with the same meaning.
inline constexpr std::string_view texturing_options[] = {"post", "pre_post", "pre", "demodulate"};
inline constexpr PassTypeSetting texturing =
    choice("texturing", texturing_options,
           "where albedo is applied. post: after scattering (keeps texture detail); pre_post: its square "
           "root before and after; pre: before; demodulate: lighting already contains albedo, which is "
           "divided out before scattering and multiplied back after it");
} // namespace setting

} // namespace dermis::subsurface
