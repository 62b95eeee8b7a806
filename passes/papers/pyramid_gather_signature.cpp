// Baseline: the plain pyramid read through cubic B-splines.

#include "passes/common/dispatch.hpp"
#include "passes/common/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {

using port::level_port;

constexpr Port gather_ports[] = {
    level_port("level_0"), level_port("level_1"), level_port("level_2"), level_port("level_3"),
    level_port("level_4"), level_port("level_5"), level_port("level_6"), level_port("level_7"),
    level_port("level_8"), port::material,        port::depth,           port::scatter_scale,
    port::tiles,           port::arguments,       port::scattered,
};

} // namespace

const PassType pyramid_gather_type{
    .name = "subsurface.pyramid_gather",
    .shader = "papers/subsurface_pyramid_gather",
    .doc = "Sums the plain pyramid's levels with weights of each listed pixel. Ignores depth and other "
           "profiles.",
    .ports = gather_ports,
    .settings = {},
    .dispatch = over_tiles,
    .side_effects = false,
};

} // namespace dermis::subsurface
