// Scattering by rays: light that enters wherever the host's scene has surfaces of the same profile.

#include "passes/common/dispatch.hpp"
#include "passes/common/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {

constexpr std::string_view reservoirs_doc =
    "four elements per pixel of the render rectangle, row by row; see docs/restir.md";
constexpr std::string_view domains_doc =
    "two elements per pixel of the render rectangle, row by row: the part of its paths that the pixel "
    "determines; 0 where nothing was written";
constexpr std::string_view kept_lights_doc = "copy of `lights`, as many as fit into the buffer";

constexpr Port normal{"normal",
                      Usage::sampled_image,
                      false,
                      "texture2D",
                      "geometric normal in view space, unit length",
                      port::light_formats};
constexpr Port scene{
    "scene", Usage::acceleration_structure, false, "accelerationStructureEXT",
    "geometry that rays intersect; an instance's custom index is its element in `instances`"};
constexpr Port vertices{
    "vertices", Usage::storage_buffer_read, false, "vec4",
    "two elements per vertex: position and normal in object space; the fourth component is unused"};
constexpr Port indices{"indices", Usage::storage_buffer_read, false, "uint", "three elements per triangle"};
constexpr Port instances{
    "instances", Usage::storage_buffer_read, false, "ray_instance",
    "64 bytes each: three rows of the world-from-object matrix, first vertex, first index, profile id, 0"};
constexpr Port lights{"lights", Usage::storage_buffer_read, false, "light_source",
                      "64 bytes each, in the layout of shaders/restir/lights.glsl"};

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
     .unit = "paths per pixel",
     .doc = "number of candidate paths; one path is kept with a probability proportional to its light"},
};

constexpr std::string_view shift_options[] = {"reconnection", "delayed", "hybrid", "sequential"};
constexpr PassTypeSetting shift =
    setting::choice("shift", shift_options, "mapping of a path of one pixel to a path of another pixel");

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
        setting::real("cap", 20, 0, 1000, "times the frame", "maximum confidence weight of the history")),
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
     .doc = "index of the spatial pass; with the shift `sequential`, pass 0 reconnects and pass 1 replays"},
    {.name = "neighbours",
     .type = SettingType::integer,
     .default_value = integer_value(4),
     .minimum = 1,
     .maximum = 8,
     .options = {},
     .unit = "pixels",
     .doc = "number of neighbouring pixels that are tested"},
};

constexpr Port resolve_ports[] = {
    {"lighting", Usage::sampled_image, false, "texture2D",
     "diffuse irradiance before albedo, linear; used where light does not scatter", port::color_formats},
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
    .doc = "Samples paths from each pixel through the object to a light with probe rays, and keeps one path.",
    .ports = initial_ports,
    .settings = initial_settings,
    .dispatch = over_tiles,
    .side_effects = false,
    .features = bit_of(Feature::ray_query),
};

const PassType restir_temporal_type{
    .name = "restir.temporal",
    .shader = "restir/restir_temporal",
    .doc = "Merges each pixel's path with the path of the same surface in the previous frame.",
    .ports = temporal_ports,
    .settings = temporal_settings,
    .dispatch = over_tiles,
    .side_effects = false,
    .features = bit_of(Feature::ray_query),
    .mixes = temporal_mixes,
};

const PassType restir_spatial_type{
    .name = "restir.spatial",
    .shader = "restir/restir_spatial",
    .doc = "Merges each pixel's path with paths of neighbouring pixels that show the same profile.",
    .ports = spatial_ports,
    .settings = spatial_settings,
    .dispatch = over_tiles,
    .side_effects = false,
    .features = bit_of(Feature::ray_query),
};

const PassType restir_resolve_type{
    .name = "restir.resolve",
    .shader = "restir/restir_resolve",
    .doc = "Computes the light of each pixel's kept path; channels that do not scatter keep the pixel's own "
           "light.",
    .ports = resolve_ports,
    .settings = resolve_settings,
    .dispatch = over_tiles,
    .side_effects = false,
};

} // namespace dermis::subsurface
