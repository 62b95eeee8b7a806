// Samples by tile: error estimate of each tile, allocation of samples, and refinement by samples.

#include "passes/common/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {

constexpr PassTypeSetting below = setting::per_frame(
    setting::real("below", 0.93, 0, 2, "", "confidence below which a pixel may be sampled"));

constexpr Format before_formats[] = {Format::rgba16f, Format::rgba32f, Format::rg16f};
constexpr Port tile_error_ports[] = {
    port::sap_scattered,
    port::optional(
        port::sampled("light",
                      "light before scattering: light that scattering did not change counts less; "
                      "unbound: all light counts equally",
                      before_formats)),
    port::optional(port::sampled_uint(
        "surface", "image of level 0, if 'light' is the image of level 0", port::surface_formats)),
    port::material,
    port::importance,
    port::tiles,
    port::arguments,
    port::writer_of(port::tile_errors),
};
constexpr PassTypeSetting tile_error_settings[] = {below};

constexpr Port before =
    port::optional(port::read_buffer("before", "uint", "samples_per_tile of the previous frame"));
constexpr Port demand = port::read_buffer(
    "demand", "uint",
    "per run of 1,024 tiles in row order: the cost of the steps of samples that its tiles can "
    "take, by bin of error reduction per cost (256 bins)");

constexpr Port sample_demand_ports[] = {
    port::classes,
    port::tile_errors,
    before,
    port::writer_of(demand),
};

constexpr Port allocate_samples_ports[] = {
    port::classes,
    port::tile_errors,
    before,
    // Unbound: each group sums the costs of all tiles, which is slow on a GPU.
    port::optional(demand),
    port::list_state,
    port::writer_of(port::samples_per_tile),
    port::writer_of(port::tiles),
    port::writer_of(port::arguments),
};

constexpr auto tile_refine_ports =
    join(port::sap_levels,
         std::array{
             port::classes, port::samples_per_tile, port::tiles, port::arguments,
             port::updated("scattered", "rgb: scattered light; a: confidence; refined in place")});
constexpr PassTypeSetting tile_refine_settings[] = {
    setting::lod_bias(-1.5),
    below,
    setting::sample_weight(0.05),
};

} // namespace

const PassType tile_error_estimate_type{
    .name = "subsurface.tile_error_estimate",
    .shader = "sap/subsurface_tile_error_estimate",
    .doc =
        "Estimates the error of each tile: the confidence that the pyramid lacks, times light and "
        "importance.",
    .ports = tile_error_ports,
    .settings = tile_error_settings,
    .dispatch = over_tiles,
};

const PassType sample_demand_type{
    .name = "subsurface.sample_demand",
    .shader = "sap/subsurface_sample_demand",
    .doc = "Sums the cost of the steps of samples that tiles can take, for "
           "subsurface.allocate_samples.",
    .ports = sample_demand_ports,
    .settings = {},
    .dispatch = over_tile_runs,
};

const PassType allocate_samples_type{
    .name = "subsurface.allocate_samples",
    .shader = "sap/subsurface_allocate_samples",
    .doc = "Allocates samples to tiles in the order of error reduction per cost, until the frame's "
           "budget is "
           "spent.",
    .ports = allocate_samples_ports,
    .settings = {},
    .dispatch = over_tile_runs,
};

const PassType tile_refine_type{
    .name = "subsurface.tile_refine",
    .shader = "sap/subsurface_tile_refine",
    .doc = "Blends samples into the pyramid's light in tiles that have samples.",
    .ports = tile_refine_ports,
    .settings = tile_refine_settings,
    .dispatch = over_tiles,
};

} // namespace dermis::subsurface
