// Scattering by rays: light that enters wherever the host's scene has surfaces of the same profile.

#include "passes/common/signatures/signatures.hpp"

namespace dermis::subsurface {

namespace {

constexpr std::string_view reservoirs_doc =
    "four elements per pixel of the render rectangle, row by row; see docs/restir.md";
constexpr std::string_view domains_doc = "two elements per pixel of the render rectangle, row by "
                                         "row: the part of its paths that the pixel "
                                         "determines; 0 where nothing was written";
constexpr std::string_view kept_lights_doc = "copy of `lights`, as many as fit into the buffer";

constexpr Port normal =
    port::sampled("normal", "geometric normal in view space, unit length", port::light_formats);
constexpr Port scene{
    "scene", Usage::acceleration_structure, false, "accelerationStructureEXT",
    "geometry that rays intersect; an instance's custom index is its element in `instances`"};
constexpr Port vertices = port::read_buffer(
    "vertices", "vec4",
    "two elements per vertex: position and normal in object space; the fourth component is unused");
constexpr Port indices = port::read_buffer("indices", "uint", "three elements per triangle");
constexpr Port instances = port::read_buffer("instances", "ray_instance",
                                             "64 bytes each: three rows of the world-from-object "
                                             "matrix, first vertex, first index, profile id, 0");
constexpr Port lights = port::read_buffer(
    "lights", "light_source", "64 bytes each, in the layout of shaders/restir/lights.glsl");
constexpr std::array traced{scene, vertices, indices, instances, lights};
constexpr std::array surface{port::material, port::depth, normal, port::scatter_scale};
constexpr std::array tiles{port::tiles, port::arguments};

constexpr Port reservoirs = port::read_buffer("reservoirs", "uvec4", reservoirs_doc);
constexpr Port merged = port::written_buffer("merged", "uvec4", reservoirs_doc);

constexpr auto initial_ports =
    join(surface, traced, tiles, std::array{port::writer_of(reservoirs)});

constexpr PassTypeSetting initial_settings[] = {
    setting::integer(
        "samples", 1, 1, 1024, "paths per pixel",
        "number of candidate paths; one path is kept with a probability proportional to its light"),
};

constexpr std::string_view shift_options[] = {"reconnection", "delayed", "hybrid", "sequential"};
constexpr PassTypeSetting shift = setting::choice(
    "shift", shift_options, "mapping of a path of one pixel to a path of another pixel");

constexpr auto temporal_ports = join(
    surface, std::array{port::velocity}, traced,
    std::array{reservoirs, port::read_buffer("reservoirs_before", "uvec4", reservoirs_doc),
               port::read_buffer("domains_before", "uvec4", domains_doc),
               port::read_buffer("lights_before", "light_source", kept_lights_doc)},
    tiles,
    std::array{merged, Port{"domains", Usage::storage_buffer_update, false, "uvec4", domains_doc},
               port::written_buffer("lights_kept", "light_source", kept_lights_doc)});

constexpr PassTypeSetting temporal_settings[] = {
    shift,
    setting::per_frame(setting::real("cap", 20, 0, 1000, "times the frame",
                                     "maximum confidence weight of the history")),
};

constexpr auto spatial_ports =
    join(surface, traced, std::array{port::classes, reservoirs}, tiles, std::array{merged});

constexpr PassTypeSetting spatial_settings[] = {
    shift,
    setting::integer("pass", 0, 0, 1, "",
                     "index of the spatial pass; with the shift `sequential`, pass 0 reconnects "
                     "and pass 1 replays"),
    setting::integer("neighbours", 4, 1, 8, "pixels",
                     "number of neighbouring pixels that are tested"),
};

constexpr auto resolve_ports = join(
    std::array{port::sampled(
        "lighting", "diffuse irradiance before albedo, linear; used where light does not scatter",
        port::color_formats)},
    surface, std::array{port::albedo, vertices, indices, instances, reservoirs}, tiles,
    std::array{port::scattered});

constexpr PassTypeSetting resolve_settings[] = {setting::texturing};

constexpr HistoryWeight temporal_mixes[] = {{"merged", "cap", HistoryWeight::By::cap}};

} // namespace

const PassType restir_initial_type{
    .name = "restir.initial",
    .shader = "restir/restir_initial",
    .doc = "Samples paths from each pixel through the object to a light with probe rays, and keeps "
           "one path.",
    .ports = initial_ports,
    .settings = initial_settings,
    .dispatch = over_tiles,
    .features = bit_of(Feature::ray_query),
};

const PassType restir_temporal_type{
    .name = "restir.temporal",
    .shader = "restir/restir_temporal",
    .doc = "Merges each pixel's path with the path of the same surface in the previous frame.",
    .ports = temporal_ports,
    .settings = temporal_settings,
    .dispatch = over_tiles,
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
    .features = bit_of(Feature::ray_query),
};

const PassType restir_resolve_type{
    .name = "restir.resolve",
    .shader = "restir/restir_resolve",
    .doc = "Computes the light of each pixel's kept path; channels that do not scatter keep the "
           "pixel's own "
           "light.",
    .ports = resolve_ports,
    .settings = resolve_settings,
    .dispatch = over_tiles,
};

} // namespace dermis::subsurface
