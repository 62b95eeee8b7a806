// Variance of the light of each tile: an alternative to the tile error estimate.

#include "passes/common/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {

constexpr Port tile_variance_ports[] = {
    port::light, port::material,  port::importance,
    port::tiles, port::arguments, port::writer_of(port::tile_errors),
};
constexpr PassTypeSetting tile_variance_settings[] = {
    setting::per_frame(setting::real("min_contrast", 0.01, 0, 4, "",
                                     "mean deviation of exposed luminance from the tile's mean, "
                                     "below which light counts as uniform")),
};

} // namespace

const PassType tile_variance_type{
    .name = "subsurface.tile_variance",
    .shader = "papers/subsurface_tile_variance",
    .doc = "Computes the variation of light inside each tile, times importance.",
    .ports = tile_variance_ports,
    .settings = tile_variance_settings,
    .dispatch = over_tiles,
};

} // namespace dermis::subsurface
