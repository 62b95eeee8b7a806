// The techniques: light in, scattered light out.

#include "passes/subsurface/signatures.hpp"

namespace dermis::subsurface {

namespace {

constexpr Port light{"light", Usage::sampled_image, false, "texture2D", "as subsurface.setup writes it", {}};
constexpr Port scattered{"scattered",
                         Usage::storage_image_write,
                         false,
                         "image2D",
                         "scattered light where there is subsurface, undefined elsewhere",
                         {}};

constexpr Port slope{"slope", Usage::sampled_image, false, "texture2D", "as subsurface.setup writes it", {}};

constexpr Port burley_ports[] = {
    light, slope, port::material, port::depth, port::scatter_scale, port::tiles, port::arguments, scattered,
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

constexpr std::string_view axis_options[] = {"horizontal", "vertical"};
constexpr std::string_view taps_options[] = {"11", "17", "25"};
constexpr Port separable_ports[] = {
    light,
    {"blurred",
     Usage::sampled_image,
     true,
     "texture2D",
     "the horizontal pass's result; bound for the vertical pass",
     {}},
    port::material,
    port::depth,
    port::scatter_scale,
    port::tiles,
    port::arguments,
    scattered,
};
constexpr KindSetting separable_settings[] = {
    {.name = "axis",
     .type = SettingType::enumeration,
     .default_value = option_value(0),
     .minimum = 0,
     .maximum = 0,
     .options = axis_options,
     .unit = "",
     .doc = "of this pass; a graph runs horizontal, then vertical"},
    {.name = "taps",
     .type = SettingType::enumeration,
     .default_value = option_value(1),
     .minimum = 0,
     .maximum = 0,
     .options = taps_options,
     .unit = "taps",
     .doc = "reads along the axis"},
};

} // namespace

const PassKind burley_kind{
    .name = "subsurface.burley",
    .shader = "subsurface_burley",
    .doc = "Importance sampling of Burley's normalised diffusion on a disc, weighted by 3-D distance and "
           "patch area.",
    .ports = burley_ports,
    .settings = burley_settings,
    .dispatch = DispatchShape::over_tiles,
    .side_effects = false,
};

const PassKind separable_kind{
    .name = "subsurface.separable",
    .shader = "subsurface_separable",
    .doc = "One 1-D pass of a delta plus rank-1 kernel fitted to Burley's profile.",
    .ports = separable_ports,
    .settings = separable_settings,
    .dispatch = DispatchShape::over_tiles,
    .side_effects = false,
};

} // namespace dermis::subsurface
