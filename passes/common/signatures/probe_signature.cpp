// The error probe: independent estimates of the scattered light at a few pixels of the frame.

#include "passes/common/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {

constexpr auto probe_ports =
    join(port::at_few_texels(std::array{
             port::optional(port::sampled(
                 "scattered",
                 "scattered light whose error is measured; tiles that do not scatter show "
                 "their own light, as do all tiles if the port is unbound",
                 port::color_formats)),
             port::lighting, port::material, port::depth, port::scatter_scale, port::albedo}),
         std::array{port::classes});
constexpr PassTypeSetting probe_settings[] = {
    setting::texturing,
    setting::probed_tiles,
    setting::probe_interval,
};

} // namespace

const PassType probe_type{
    .name = "subsurface.probe",
    .shader = "common/subsurface_probe",
    .doc =
        "Estimates the frame's error and its uncertainty at pixels of a few tiles, sampled with "
        "known probabilities: compares with four independent estimates of 256 samples each. Does "
        "the same for the light before scattering and for subsurface.separable with 25 taps, so "
        "that a choice knows the error of both although they do not run.",
    .ports = probe_ports,
    .settings = probe_settings,
    .dispatch = over_probed_tiles(128),
    .side_effects = true, // reports to the host
};

} // namespace dermis::subsurface
