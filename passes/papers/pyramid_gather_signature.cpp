// Baseline: the plain pyramid read through cubic B-splines.

#include "passes/common/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {

constexpr auto ports = join(std::array{port::level("level_0")}, port::levels_1_to_8,
                            std::array{port::material, port::depth, port::scatter_scale,
                                       port::tiles, port::arguments, port::scattered});

} // namespace

const PassType pyramid_gather_type{
    .name = "subsurface.pyramid_gather",
    .shader = "papers/subsurface_pyramid_gather",
    .doc = "Sums the plain pyramid's levels with weights of each listed pixel. Ignores depth and "
           "other "
           "profiles.",
    .ports = ports,
    .settings = {},
    .dispatch = over_tiles,
};

} // namespace dermis::subsurface
