// The error probe: the reference at a few pixels of the frame.

#include "passes/common/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {

constexpr Port probe_ports[] = {
    port::optional(
        port::sampled("scattered",
                      "scattered light whose error is measured; tiles that do not scatter show "
                      "their own light, as do all tiles if the port is unbound",
                      port::color_formats)),
    port::lighting,
    port::material,
    port::depth,
    port::scatter_scale,
    port::albedo,
    port::classes,
};
constexpr PassTypeSetting probe_settings[] = {
    setting::texturing,
    setting::integer(
        "tiles", 8, 1, 32, "tiles",
        "number of tiles per frame; the reference is computed at four pixels of each tile"),
};

} // namespace

const PassType probe_type{
    .name = "subsurface.probe",
    .shader = "common/subsurface_probe",
    .doc = "Computes the reference at pixels of a few tiles, sampled with known probabilities, to "
           "estimate "
           "the frame's error and its uncertainty.",
    .ports = probe_ports,
    .settings = probe_settings,
    .dispatch = over_tile_grid,
    .side_effects = true, // reports to the host
};

} // namespace dermis::subsurface
