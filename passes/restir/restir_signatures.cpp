// Scattering by rays: light that enters wherever the host's scene has surfaces of the same profile.

#include "passes/common/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {

constexpr std::string_view reservoirs_doc =
    "four elements a pixel of the render rectangle, row by row: docs/restir.md";
constexpr std::string_view domains_doc = "two elements a pixel of the render rectangle, row by row: what it "
                                         "fixed of its paths; 0 where nothing was written";
constexpr std::string_view kept_lights_doc = "as `lights`, as many as there is room for";

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
                      "64 bytes each, as shaders/restir/lights.glsl has them"};

constexpr Port initial_ports[] = {
    port::material,  port::depth,
    normal,          port::scatter_scale,
    scene,           vertices,
    indices,         instances,
    lights,          port::tiles,
    port::arguments, {"reservoirs", Usage::storage_buffer_write, false, "uvec4", reservoirs_doc},
};

constexpr PassTypeSetting initial_settings[] = {
    {.name = "samples",
     .type = SettingType::integer,
     .default_value = integer_value(1),
     .minimum = 1,
     .maximum = 1024,
     .options = {},
     .unit = "paths a pixel",
     .doc = "of which one is kept, drawn by its share of their light"},
};

constexpr std::string_view shift_options[] = {"reconnection", "delayed", "hybrid", "sequential"};
constexpr PassTypeSetting shift =
    setting::choice("shift", shift_options, "how a path of one pixel becomes one of another");

constexpr Port temporal_ports[] = {
    port::material,
    port::depth,
    normal,
    port::scatter_scale,
    port::velocity,
    scene,
    vertices,
    indices,
    instances,
    lights,
    {"reservoirs", Usage::storage_buffer_read, false, "uvec4", reservoirs_doc},
    {"reservoirs_before", Usage::storage_buffer_read, false, "uvec4", reservoirs_doc},
    {"domains_before", Usage::storage_buffer_read, false, "uvec4", domains_doc},
    {"lights_before", Usage::storage_buffer_read, false, "light_source", kept_lights_doc},
    port::tiles,
    port::arguments,
    {"merged", Usage::storage_buffer_write, false, "uvec4", reservoirs_doc},
    {"domains", Usage::storage_buffer_update, false, "uvec4", domains_doc},
    {"lights_kept", Usage::storage_buffer_write, false, "light_source", kept_lights_doc},
};

constexpr PassTypeSetting temporal_settings[] = {
    shift,
    setting::per_frame(
        setting::real("cap", 20, 0, 1000, "times the frame", "that history counts for at most")),
};

constexpr Port spatial_ports[] = {
    port::material,
    port::depth,
    normal,
    port::scatter_scale,
    scene,
    vertices,
    indices,
    instances,
    lights,
    port::classes,
    {"reservoirs", Usage::storage_buffer_read, false, "uvec4", reservoirs_doc},
    port::tiles,
    port::arguments,
    {"merged", Usage::storage_buffer_write, false, "uvec4", reservoirs_doc},
};

constexpr PassTypeSetting spatial_settings[] = {
    shift,
    {.name = "pass",
     .type = SettingType::integer,
     .default_value = integer_value(0),
     .minimum = 0,
     .maximum = 1,
     .options = {},
     .unit = "",
     .doc = "which of two: of shift `sequential` the first reconnects, the second replays"},
    {.name = "neighbours",
     .type = SettingType::integer,
     .default_value = integer_value(4),
     .minimum = 1,
     .maximum = 8,
     .options = {},
     .unit = "pixels",
     .doc = "that are looked at"},
};

constexpr Port resolve_ports[] = {
    {"lighting", Usage::sampled_image, false, "texture2D",
     "diffuse irradiance before albedo, linear: where it does not scatter", port::color_formats},
    port::material,
    port::depth,
    normal,
    port::scatter_scale,
    port::albedo,
    vertices,
    indices,
    instances,
    {"reservoirs", Usage::storage_buffer_read, false, "uvec4", reservoirs_doc},
    port::tiles,
    port::arguments,
    port::scattered,
};

constexpr PassTypeSetting resolve_settings[] = {setting::texturing};

constexpr HistoryWeight temporal_mixes[] = {{"merged", "cap", HistoryWeight::By::cap}};

} // namespace

const PassType restir_initial_type{
    .name = "restir.initial",
    .shader = "restir/restir_initial",
    .doc = "Draws paths from each pixel through the object to a light, by probe rays, and keeps one of them.",
    .ports = initial_ports,
    .settings = initial_settings,
    .dispatch = DispatchShape::over_tiles,
    .side_effects = false,
    .features = bit_of(Feature::ray_query),
};

const PassType restir_temporal_type{
    .name = "restir.temporal",
    .shader = "restir/restir_temporal",
    .doc = "Merges each pixel's path with the one that its surface had in the frame before.",
    .ports = temporal_ports,
    .settings = temporal_settings,
    .dispatch = DispatchShape::over_tiles,
    .side_effects = false,
    .features = bit_of(Feature::ray_query),
    .mixes = temporal_mixes,
};

const PassType restir_spatial_type{
    .name = "restir.spatial",
    .shader = "restir/restir_spatial",
    .doc = "Merges each pixel's path with those of pixels around it that show the same profile.",
    .ports = spatial_ports,
    .settings = spatial_settings,
    .dispatch = DispatchShape::over_tiles,
    .side_effects = false,
    .features = bit_of(Feature::ray_query),
};

const PassType restir_resolve_type{
    .name = "restir.resolve",
    .shader = "restir/restir_resolve",
    .doc = "Light that the kept path of each pixel brings; its own in channels that do not scatter.",
    .ports = resolve_ports,
    .settings = resolve_settings,
    .dispatch = DispatchShape::over_tiles,
    .side_effects = false,
};

} // namespace dermis::subsurface
