// Variance of the light that reaches each tile: an alternative to the tile error estimate.

#include "passes/common/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {

constexpr Port tile_variance_ports[] = {
    port::light,
    port::filtered(port::sampled(
        "levels", "mip l - 1 is level l, of a pyramid_setup that keeps profiles apart",
        port::light_formats)),
    port::material,
    port::depth,
    port::scatter_scale,
    port::importance,
    port::tiles,
    port::arguments,
    port::writer_of(port::tile_errors),
    port::writer_of(port::tile_d),
};
constexpr PassTypeSetting tile_variance_settings[] = {
    setting::per_frame(setting::real("ratio", 0.75, 0, 100, "",
                                     "error of separable over that of samples, at d up to 1 pixel "
                                     "on a surface that faces the viewer")),
    setting::per_frame(setting::real("min_contrast", 0.01, 0, 4, "",
                                     "mean deviation of exposed luminance from its mean, "
                                     "below which light counts as uniform")),
};

} // namespace

const PassType tile_variance_type{
    .name = "subsurface.tile_variance",
    .shader = "papers/subsurface_tile_variance",
    .doc = "Computes how much the light that reaches each tile varies, times importance.",
    .ports = tile_variance_ports,
    .settings = tile_variance_settings,
    .dispatch = over_tiles,
};

} // namespace dermis::subsurface
