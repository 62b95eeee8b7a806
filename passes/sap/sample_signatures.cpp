// Samples by tile: error estimate of each tile, allocation of samples, and refinement by samples.

#include "passes/common/dispatch.hpp"
#include "passes/common/signatures/level_ports.hpp"

namespace dermis::subsurface {

namespace {

using port::importance_formats;
using port::light_formats;
using port::tile_errors_doc;
constexpr Format refined_formats[] = {Format::rgba16f};

constexpr PassTypeSetting below = setting::per_frame(
    setting::real("below", 0.8, 0, 2, "", "confidence below which a pixel may be sampled"));

constexpr Port doubt_ports[] = {
    {"scattered", Usage::sampled_image, false, "texture2D",
     "output of the pyramid. rgb: scattered light; a: confidence", light_formats},
    {"light", Usage::sampled_image, true, "texture2D",
     "light before scattering: light that scattering did not change counts less; unbound: all light counts "
     "equally",
     light_formats},
    port::material,
    {"importance", Usage::sampled_image, true, "texture2D",
     "importance of errors to the host, 0 to 1; unbound: 1 everywhere", importance_formats},
    port::tiles,
    port::arguments,
    {"tile_errors", Usage::storage_buffer_write, false, "uint", tile_errors_doc, {}},
};
constexpr PassTypeSetting doubt_settings[] = {below};

constexpr Port allot_ports[] = {
    port::classes,
    {"tile_errors", Usage::storage_buffer_read, false, "uint", tile_errors_doc, {}},
    {"before", Usage::storage_buffer_read, true, "uint", "samples_per_tile of the previous frame", {}},
    {"samples_per_tile", Usage::storage_buffer_write, false, "uint", port::samples_per_tile.doc, {}},
    {"tiles", Usage::storage_buffer_write, false, "uint", port::tiles.doc, {}},
    {"arguments", Usage::storage_buffer_write, false, "uint", port::arguments.doc, {}},
};

constexpr Port mend_ports[] = {
    port::level_light("light"),
    port::level_light("light_1"),
    port::level_light("light_2"),
    port::level_light("light_3"),
    port::level_light("light_4"),
    port::level_light("light_5"),
    port::level_surface("surface"),
    port::level_surface("surface_1"),
    port::level_surface("surface_2"),
    port::level_surface("surface_3"),
    port::level_surface("surface_4"),
    port::level_surface("surface_5"),
    port::classes,
    port::samples_per_tile,
    port::tiles,
    port::arguments,
    {"scattered", Usage::storage_image_update, false, "image2D",
     "rgb: scattered light; a: confidence; refined in place", refined_formats},
};
constexpr PassTypeSetting mend_settings[] = {
    setting::real("lod_bias", -1.5, -8, 4, "levels",
                  "offset of the mip level; at 0 a texel has the area that a sample represents"),
    below,
    setting::per_frame(setting::real("sample_weight", 0.5, 0, 1, "", "weight of the samples in the result")),
};

} // namespace

const PassType tile_error_estimate_type{
    .name = "subsurface.tile_error_estimate",
    .shader = "sap/subsurface_tile_error_estimate",
    .doc = "Estimates the error of each tile: the confidence that the pyramid lacks, times light and "
           "importance.",
    .ports = doubt_ports,
    .settings = doubt_settings,
    .dispatch = over_tiles,
    .side_effects = false,
};

const PassType allocate_samples_type{
    .name = "subsurface.allocate_samples",
    .shader = "sap/subsurface_allocate_samples",
    .doc = "Allocates samples to tiles in the order of error reduction per cost, until the frame's budget is "
           "spent.",
    .ports = allot_ports,
    .settings = {},
    .dispatch = single_group,
    .side_effects = false,
};

const PassType tile_refine_type{
    .name = "subsurface.tile_refine",
    .shader = "sap/subsurface_tile_refine",
    .doc = "Blends samples into the pyramid's light in tiles that have samples.",
    .ports = mend_ports,
    .settings = mend_settings,
    .dispatch = over_tiles,
    .side_effects = false,
};

} // namespace dermis::subsurface
