// The error probe: the reference at a few pixels of the frame.

#include "passes/common/dispatch.hpp"
#include "passes/common/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {

constexpr Port probe_ports[] = {
    {"scattered", Usage::sampled_image, true, "texture2D",
     "scattered light whose error is measured; tiles that do not scatter show their own light, as do all "
     "tiles if the port is "
     "unbound",
     port::color_formats},
    {"lighting", Usage::sampled_image, false, "texture2D", "diffuse irradiance before albedo, linear",
     port::color_formats},
    port::material,
    port::depth,
    port::scatter_scale,
    port::albedo,
    {"classes", Usage::storage_buffer_read, false, "uint", "output of subsurface.classify", {}},
};
constexpr PassTypeSetting probe_settings[] = {
    setting::texturing,
    {.name = "tiles",
     .type = SettingType::integer,
     .default_value = integer_value(8),
     .minimum = 1,
     .maximum = 32,
     .options = {},
     .unit = "tiles",
     .doc = "number of tiles per frame; the reference is computed at four pixels of each tile"},
};

} // namespace

const PassType probe_type{
    .name = "subsurface.probe",
    .shader = "common/subsurface_probe",
    .doc = "Computes the reference at pixels of a few tiles, sampled with known probabilities, to estimate "
           "the frame's error and its uncertainty.",
    .ports = probe_ports,
    .settings = probe_settings,
    .dispatch = over_tile_grid,
    .side_effects = true, // reports to the host
};

} // namespace dermis::subsurface
