// The techniques: light in, scattered light out.

#include "passes/subsurface/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {

constexpr Port light{
    "light", Usage::sampled_image, false, "texture2D", "as subsurface.setup writes it", port::light_formats};

constexpr Port slope{
    "slope", Usage::sampled_image, false, "texture2D", "as subsurface.setup writes it", port::way_formats};

constexpr Port burley_ports[] = {
    light,       slope,           port::material,  port::depth, port::scatter_scale,
    port::tiles, port::arguments, port::scattered,
};
constexpr KindSetting burley_settings[] = {
    {.name = "samples",
     .type = SettingType::integer,
     .default_value = integer_value(32),
     .minimum = 4,
     .maximum = 4096,
     .options = {},
     .unit = "samples a pixel",
     .doc = "stratified radii, golden angle; the error falls about as n^-0.7"},
};

constexpr std::string_view inverse_options[] = {"polynomial", "exact", "approximate"};
constexpr std::string_view weighting_options[] = {"sampler", "profile"};
constexpr std::string_view normalise_options[] = {"self", "none"};
constexpr std::string_view direct_options[] = {"inscribed", "circumscribed", "none"};
constexpr KindSetting fixed_settings[] = {
    {.name = "samples",
     .type = SettingType::integer,
     .default_value = integer_value(16),
     .minimum = 1,
     .maximum = 4096,
     .options = {},
     .unit = "samples a pixel",
     .doc = "points of the R2 sequence beyond the direct radius; the error falls about as n^-0.7"},
    setting::choice(
        "inverse", inverse_options,
        "of Burley's distribution: polynomial, within .5 %; exact; approximate, c = 2.5715 (Golubev 2019). "
        "Other profiles have a table"),
    setting::choice(
        "weighting", weighting_options,
        "divide by the sampler's own density, which is unbiased, or by the profile's, as published"),
    setting::choice("normalise", normalise_options,
                    "self: by the sum of weights; none: unbiased, loses what falls outside of the surface"),
    setting::choice(
        "direct", direct_options,
        "radius of the pixel's own light: inscribed in the pixel (unbiased), circumscribed (as published), "
        "none"),
};

constexpr std::string_view axis_options[] = {"horizontal", "vertical"};
constexpr std::string_view taps_options[] = {"11", "17", "25"};
constexpr std::string_view kernel_options[] = {"fitted", "jimenez"};
constexpr Port separable_ports[] = {
    light,
    {"blurred", Usage::sampled_image, true, "texture2D",
     "the horizontal pass's result; bound for the vertical pass", port::color_formats},
    port::material,
    port::depth,
    port::scatter_scale,
    port::tiles,
    port::arguments,
    port::scattered,
};
constexpr KindSetting separable_settings[] = {
    setting::choice("axis", axis_options, "of this pass; a graph runs horizontal, then vertical"),
    {.name = "taps",
     .type = SettingType::enumeration,
     .default_value = option_value(1),
     .minimum = 0,
     .maximum = 0,
     .options = taps_options,
     .unit = "taps",
     .doc = "reads along the axis"},
    setting::choice(
        "kernel", kernel_options,
        "fitted to each profile for each projected d; jimenez: the published artist-friendly kernel"),
};

} // namespace

const PassKind burley_kind{
    .name = "subsurface.burley",
    .shader = "subsurface_burley",
    .doc = "Importance sampling of the profile at stratified radii, weighted by 3-D distance and patch area.",
    .ports = burley_ports,
    .settings = burley_settings,
    .dispatch = DispatchShape::over_tiles,
    .side_effects = false,
};

const PassKind fixed_kind{
    .name = "subsurface.fixed",
    .shader = "subsurface_fixed",
    .doc = "Importance sampling of the widest channel at points of the R2 sequence, weighted by 3-D distance "
           "and "
           "patch area.",
    .ports = burley_ports,
    .settings = fixed_settings,
    .dispatch = DispatchShape::over_tiles,
    .side_effects = false,
};

const PassKind separable_kind{
    .name = "subsurface.separable",
    .shader = "subsurface_separable",
    .doc =
        "One 1-D pass of a separable kernel: delta plus rank 1 fitted to the profile, or the published one.",
    .ports = separable_ports,
    .settings = separable_settings,
    .dispatch = DispatchShape::over_tiles,
    .side_effects = false,
};

} // namespace dermis::subsurface
