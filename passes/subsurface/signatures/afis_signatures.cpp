// Filtered importance sampling. Its levels come from a pyramid_setup with `profiles` apart.

#include "passes/subsurface/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {

constexpr Port afis_ports[] = {
    {"light", Usage::sampled_image, false, "texture2D", "as subsurface.setup writes it", {}},
    {"slope", Usage::sampled_image, false, "texture2D", "as subsurface.setup writes it", {}},
    port::level_port("level_1"),
    port::level_port("level_2"),
    port::level_port("level_3"),
    port::level_port("level_4"),
    port::level_port("level_5"),
    port::level_port("level_6"),
    port::level_port("level_7"),
    port::level_port("level_8"),
    port::material,
    port::depth,
    port::scatter_scale,
    port::tiles,
    port::arguments,
    port::scattered,
};

constexpr std::string_view sequence_options[] = {"continued", "hashed", "stratified"};
constexpr std::string_view channels_options[] = {"widest", "mixture"};
constexpr std::string_view inverse_options[] = {"polynomial", "exact", "approximate"};
constexpr std::string_view weighting_options[] = {"sampler", "profile"};
constexpr std::string_view surface_options[] = {"patch", "distance"};
constexpr std::string_view direct_options[] = {"inscribed", "circumscribed", "none"};
constexpr std::string_view estimator_options[] = {"self", "centred", "none"};
constexpr std::string_view mips_options[] = {"trilinear", "whole", "none"};

constexpr KindSetting afis_settings[] = {
    {.name = "samples",
     .type = SettingType::integer,
     .default_value = integer_value(16),
     .minimum = 1,
     .maximum = 4096,
     .options = {},
     .unit = "samples a pixel",
     .doc = "beyond the direct radius"},
    {.name = "lod_bias",
     .type = SettingType::real,
     .default_value = {SettingType::real, 0, -1.0},
     .minimum = -8,
     .maximum = 4,
     .options = {},
     .unit = "levels",
     .doc = "on the level whose texels have the area that a sample stands for"},
    setting::choice(
        "sequence", sequence_options,
        "continued: R2 goes on from frame to frame; hashed: R2 begins anew in each; stratified: radii, "
        "golden angle, both shifted by R2 from frame to frame"),
    setting::choice(
        "channels", channels_options,
        "whose radii are drawn: the widest channel's or those of the mean of all, for Burley's profile"),
    setting::choice(
        "inverse", inverse_options,
        "of the widest channel's distribution: polynomial, within .5 %; exact; approximate, c = 2.5715", 1),
    setting::choice("weighting", weighting_options,
                    "divide by the sampler's own density or by the profile's, as published"),
    setting::choice(
        "surface", surface_options,
        "patch: the profile at the distance in space times the area of the patch; distance: without the "
        "area"),
    setting::choice("direct", direct_options,
                    "radius of the pixel's own light: inscribed in the pixel, circumscribed, none"),
    setting::choice(
        "estimator", estimator_options,
        "self: by the sum of weights; centred: what the weights lack or have too much is own light; none"),
    setting::choice("mips", mips_options,
                    "levels between two, rounded to one, or the pixel under the sample alone"),
};

} // namespace

const PassKind afis_kind{
    .name = "subsurface.afis",
    .shader = "subsurface_afis",
    .doc = "Filtered importance sampling: samples read the level of a masked chain that fits their density.",
    .ports = afis_ports,
    .settings = afis_settings,
    .dispatch = DispatchShape::over_tiles,
    .side_effects = false,
};

} // namespace dermis::subsurface
