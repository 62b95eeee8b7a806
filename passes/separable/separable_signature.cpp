// The separable kernel: one pass per axis.

#include "passes/common/dispatch.hpp"
#include "passes/common/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {

using port::light;

constexpr std::string_view axis_options[] = {"horizontal", "vertical"};
constexpr std::string_view taps_options[] = {"11", "17", "25"};
constexpr std::string_view kernel_options[] = {"fitted", "jimenez"};
constexpr Port separable_ports[] = {
    light,
    {"blurred", Usage::sampled_image, true, "texture2D",
     "result of the horizontal pass; bound for the vertical pass", port::color_formats},
    port::material,
    port::depth,
    port::scatter_scale,
    port::tiles,
    port::arguments,
    port::scattered,
};
constexpr PassTypeSetting separable_settings[] = {
    setting::choice("axis", axis_options,
                    "axis of this pass; a graph runs the horizontal pass, then the vertical pass"),
    {.name = "taps",
     .type = SettingType::enumeration,
     .default_value = option_value(1),
     .minimum = 0,
     .maximum = 0,
     .options = taps_options,
     .unit = "taps",
     .doc = "number of reads along the axis"},
    setting::choice("kernel", kernel_options,
                    "fitted: kernel fitted to each profile for each projected d; jimenez: the published "
                    "artist-friendly kernel"),
};

} // namespace

const PassType separable_type{
    .name = "subsurface.separable",
    .shader = "separable/subsurface_separable",
    .doc = "Applies one 1-D pass of a separable kernel: delta plus rank 1, fitted to the profile, or the "
           "published kernel.",
    .ports = separable_ports,
    .settings = separable_settings,
    .dispatch = over_tiles,
    .side_effects = false,
};

} // namespace dermis::subsurface
