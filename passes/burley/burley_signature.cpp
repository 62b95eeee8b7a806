// Importance sampling of Burley's profile.

#include "passes/common/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {

constexpr PassTypeSetting settings[] = {
    setting::samples(32, 4,
                     "number of samples, with stratified radii and golden angle; the error "
                     "decreases about as n^-0.7"),
};

} // namespace

const PassType burley_type{
    .name = "subsurface.burley",
    .shader = "burley/subsurface_burley",
    .doc = "Samples the profile by importance at stratified radii, weighted by 3-D distance and "
           "patch area.",
    .ports = port::burley_ports,
    .settings = settings,
    .dispatch = over_tiles,
};

} // namespace dermis::subsurface
