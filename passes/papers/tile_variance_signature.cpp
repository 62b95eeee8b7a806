// Variance of the light of each tile: an alternative to the tile error estimate.

#include "passes/common/dispatch.hpp"
#include "passes/common/signatures/level_ports.hpp"

namespace dermis::subsurface {

namespace {

using port::importance_formats;
using port::light_formats;
using port::tile_errors_doc;

constexpr Port contrast_ports[] = {
    {"light", Usage::sampled_image, false, "texture2D", "output of subsurface.setup", light_formats},
    port::material,
    {"importance", Usage::sampled_image, true, "texture2D",
     "importance of errors to the host, 0 to 1; unbound: 1 everywhere", importance_formats},
    port::tiles,
    port::arguments,
    {"tile_errors", Usage::storage_buffer_write, false, "uint", tile_errors_doc, {}},
};
constexpr PassTypeSetting contrast_settings[] = {
    setting::per_frame(setting::real(
        "min_contrast", 0.01, 0, 4, "",
        "mean deviation of exposed luminance from the tile's mean, below which light counts as uniform")),
};

} // namespace

const PassType tile_variance_type{
    .name = "subsurface.tile_variance",
    .shader = "papers/subsurface_tile_variance",
    .doc = "Computes the variation of light inside each tile, times importance.",
    .ports = contrast_ports,
    .settings = contrast_settings,
    .dispatch = over_tiles,
    .side_effects = false,
};

} // namespace dermis::subsurface
