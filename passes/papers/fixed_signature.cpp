// Baseline: a fixed number of samples without mips.

#include "passes/common/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {

constexpr std::string_view normalise_options[] = {"self", "none"};
constexpr PassTypeSetting fixed_settings[] = {
    setting::samples(
        16, 1, "number of R2 points beyond the direct radius; the error decreases about as n^-0.7"),
    setting::choice(
        "inverse", setting::inverse_options,
        "inverse of Burley's distribution: polynomial (error below 0.5 %), exact, or approximate "
        "(c = 2.5715, Golubev 2019). Other profiles use a table"),
    setting::choice(
        "weighting", setting::weighting_options,
        "probability density by which a sample is divided. sampler: that of the sampler "
        "(unbiased); profile: that of the profile, as published"),
    setting::choice(
        "normalise", normalise_options,
        "normalisation. self: divide by the sum of weights; none: unbiased, loses light of "
        "samples outside the surface"),
    setting::choice(
        "direct", setting::direct_options,
        "radius within which the pixel's own light is used: inscribed in the pixel (unbiased), "
        "circumscribed (as published), "
        "none"),
};

} // namespace

const PassType fixed_type{
    .name = "subsurface.fixed",
    .shader = "papers/subsurface_fixed",
    .doc = "Samples the widest channel's profile by importance at points of the R2 sequence, "
           "weighted by 3-D "
           "distance and patch area.",
    .ports = port::burley_ports,
    .settings = fixed_settings,
    .dispatch = over_tiles,
};

} // namespace dermis::subsurface
