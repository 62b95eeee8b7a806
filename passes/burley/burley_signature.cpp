// Importance sampling of Burley's profile.

#include "passes/common/dispatch.hpp"
#include "passes/common/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {

using port::burley_ports;
constexpr PassTypeSetting burley_settings[] = {
    {.name = "samples",
     .type = SettingType::integer,
     .default_value = integer_value(32),
     .minimum = 4,
     .maximum = 4096,
     .options = {},
     .unit = "samples per pixel",
     .doc = "number of samples, with stratified radii and golden angle; the error decreases about as n^-0.7"},
};

} // namespace

const PassType burley_type{
    .name = "subsurface.burley",
    .shader = "burley/subsurface_burley",
    .doc = "Samples the profile by importance at stratified radii, weighted by 3-D distance and patch area.",
    .ports = burley_ports,
    .settings = burley_settings,
    .dispatch = over_tiles,
    .side_effects = false,
};

} // namespace dermis::subsurface
