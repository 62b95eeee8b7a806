// The separable kernel: one pass per axis.

#include "passes/common/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {

constexpr std::string_view axis_options[] = {"horizontal", "vertical"};
constexpr std::string_view taps_options[] = {"11", "17", "25"};
constexpr std::string_view kernel_options[] = {"fitted", "jimenez"};
constexpr Port separable_ports[] = {
    port::light,
    port::optional(port::sampled("blurred",
                                 "result of the horizontal pass; bound for the vertical pass",
                                 port::color_formats)),
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
    setting::choice("taps", taps_options, "number of reads along the axis", 1, "taps"),
    setting::choice(
        "kernel", kernel_options,
        "fitted: kernel fitted to each profile for each projected d; jimenez: the published "
        "artist-friendly kernel"),
};

} // namespace

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

} // namespace dermis::subsurface
