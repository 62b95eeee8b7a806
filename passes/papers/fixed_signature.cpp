// Baseline: a fixed number of samples without mips.

#include "passes/common/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {

using port::burley_ports;

constexpr std::string_view inverse_options[] = {"polynomial", "exact", "approximate"};
constexpr std::string_view weighting_options[] = {"sampler", "profile"};
constexpr std::string_view normalise_options[] = {"self", "none"};
constexpr std::string_view direct_options[] = {"inscribed", "circumscribed", "none"};
constexpr PassTypeSetting fixed_settings[] = {
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

} // namespace

const PassType fixed_type{
    .name = "subsurface.fixed",
    .shader = "papers/subsurface_fixed",
    .doc = "Importance sampling of the widest channel at points of the R2 sequence, weighted by 3-D distance "
           "and "
           "patch area.",
    .ports = burley_ports,
    .settings = fixed_settings,
    .dispatch = DispatchShape::over_tiles,
    .side_effects = false,
};

} // namespace dermis::subsurface
