// The error probe: the reference at a few pixels of the frame.

#include "passes/common/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {

constexpr Port probe_ports[] = {
    {"scattered", Usage::sampled_image, true, "texture2D",
     "scattered light that is judged; tiles that do not scatter show their own, and all do where it is "
     "unbound",
     port::color_formats},
    {"lighting", Usage::sampled_image, false, "texture2D", "diffuse irradiance before albedo, linear",
     port::color_formats},
    port::material,
    port::depth,
    port::scatter_scale,
    port::albedo,
    {"classes", Usage::storage_buffer_read, false, "uint", "as subsurface.classify writes them", {}},
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
     .doc = "a frame, in each of which the reference is computed at four pixels"},
};

} // namespace

const PassType probe_type{
    .name = "subsurface.probe",
    .shader = "common/subsurface_probe",
    .doc = "Computes the reference at pixels of a few tiles, drawn with known probabilities: the frame's "
           "error and "
           "how sure it is.",
    .ports = probe_ports,
    .settings = probe_settings,
    .dispatch = DispatchShape::over_tile_grid,
    .side_effects = true, // reports to the host
};

} // namespace dermis::subsurface
