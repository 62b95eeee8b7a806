// Scattering by rays: light that comes in wherever the host's scene has surfaces of the same profile.

#include "passes/subsurface/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {

constexpr std::string_view reservoirs_doc = "four elements a pixel, row by row: docs/pass_kinds.md";

constexpr Port normal{"normal",
                      Usage::sampled_image,
                      false,
                      "texture2D",
                      "geometric normal in view space, unit length",
                      port::light_formats};
constexpr Port scene{"scene", Usage::acceleration_structure, false, "accelerationStructureEXT",
                     "what rays meet; an instance's custom index is its element of `instances`"};
constexpr Port vertices{"vertices", Usage::storage_buffer_read, false, "vec4",
                        "two elements a vertex: position, normal of the object, fourth unused"};
constexpr Port indices{"indices", Usage::storage_buffer_read, false, "uint", "three a triangle"};
constexpr Port instances{
    "instances", Usage::storage_buffer_read, false, "ray_instance",
    "64 bytes: three rows of world from object, first vertex, first index, profile id, 0"};
constexpr Port lights{"lights", Usage::storage_buffer_read, false, "light_source",
                      "64 bytes each, as shaders/include/restir/lights.glsl has them"};

constexpr Port initial_ports[] = {
    port::material,  port::depth,
    normal,          port::scatter_scale,
    scene,           vertices,
    indices,         instances,
    lights,          port::tiles,
    port::arguments, {"reservoirs", Usage::storage_buffer_write, false, "uvec4", reservoirs_doc},
};

constexpr KindSetting initial_settings[] = {
    {.name = "samples",
     .type = SettingType::integer,
     .default_value = integer_value(1),
     .minimum = 1,
     .maximum = 1024,
     .options = {},
     .unit = "paths a pixel",
     .doc = "of which one is kept, drawn by its share of their light"},
};

constexpr Port resolve_ports[] = {
    port::material,  port::depth,
    normal,          port::scatter_scale,
    vertices,        indices,
    instances,       port::tiles,
    port::arguments, {"reservoirs", Usage::storage_buffer_read, false, "uvec4", reservoirs_doc},
    port::scattered,
};

} // namespace

const PassKind restir_initial_kind{
    .name = "restir.initial",
    .shader = "restir_initial",
    .doc = "Draws paths from each pixel through the object to a light, by probe rays, and keeps one of them.",
    .ports = initial_ports,
    .settings = initial_settings,
    .dispatch = DispatchShape::over_tiles,
    .side_effects = false,
    .features = bit_of(Feature::ray_query),
};

const PassKind restir_resolve_kind{
    .name = "restir.resolve",
    .shader = "restir_resolve",
    .doc = "Light that the kept path of each pixel brings.",
    .ports = resolve_ports,
    .settings = {},
    .dispatch = DispatchShape::over_tiles,
    .side_effects = false,
};

} // namespace dermis::subsurface
