#pragma once
// Ports that several pass types declare with the same meaning, and functions that declare others.

#include "framegraph/model/pass_type.hpp"

#include <array>

namespace dermis::subsurface {

// Joins arrays of ports or of settings into one array.
template <class T, size_t... N> constexpr auto join(const std::array<T, N>&... parts) {
  std::array<T, (N + ...)> all{};
  size_t next = 0;
  const auto append = [&](const auto& part) {
    for (const T& item : part)
      all[next++] = item;
  };
  (append(parts), ...);
  return all;
}

namespace port {

// Allowed formats, by the channels that kernels read and write.
// Three channels.
inline constexpr Format color_formats[] = {Format::rgba16f, Format::rgba32f, Format::b10g11r11f,
                                           Format::rgba8_unorm, Format::rgba8_srgb};
// Four channels, with areas above 1.
inline constexpr Format light_formats[] = {Format::rgba16f, Format::rgba32f};
// Two channels, with negative values.
inline constexpr Format way_formats[] = {Format::rg16f, Format::rg32f, Format::rgba16f,
                                         Format::rgba32f};
// Images that a kernel loads and writes.
inline constexpr Format updated_formats[] = {Format::rgba16f};
// A level of the surface-aware pyramid: `surface` holds the channels that rg16f lacks.
inline constexpr Format sap_light_formats[] = {Format::rg16f, Format::rgba32f};
inline constexpr Format surface_formats[] = {Format::rgba32_uint};
inline constexpr Format importance_formats[] = {Format::r8_unorm, Format::r16f, Format::r32f};

// The same in full storage, where the surface holds no light.
inline constexpr Format sap_full_light_formats[] = {Format::rgba32f};

using Formats = std::span<const Format>;

// Declare an image that the kernel samples.
constexpr Port sampled(std::string_view name, std::string_view doc, Formats formats = {}) {
  return {name, Usage::sampled_image, false, "texture2D", doc, formats};
}
constexpr Port sampled_uint(std::string_view name, std::string_view doc, Formats formats = {}) {
  return {name, Usage::sampled_image, false, "utexture2D", doc, formats};
}

// Declare an image that the kernel writes at every texel that it covers.
constexpr Port written(std::string_view name, std::string_view doc, Formats formats) {
  return {name, Usage::storage_image_write, false, "image2D", doc, formats};
}
constexpr Port written_uint(std::string_view name, std::string_view doc, Formats formats) {
  return {name, Usage::storage_image_write, false, "uimage2D", doc, formats};
}

// Declares an image that the kernel loads and changes in place.
constexpr Port updated(std::string_view name, std::string_view doc) {
  return {name, Usage::storage_image_update, false, "image2D", doc, updated_formats};
}

// Declares an image that is cleared in the same frame and written where there is subsurface: texels
// that were not written read 0 in the next frame.
constexpr Port written_in_part(std::string_view name, std::string_view doc, Formats formats) {
  return {name, Usage::storage_image_update, false, "writeonly image2D", doc, formats};
}

constexpr Port read_buffer(std::string_view name, std::string_view element, std::string_view doc) {
  return {name, Usage::storage_buffer_read, false, element, doc};
}
constexpr Port written_buffer(std::string_view name, std::string_view element,
                              std::string_view doc) {
  return {name, Usage::storage_buffer_write, false, element, doc};
}
// Declares the port through which another pass writes the buffer that `port` reads.
constexpr Port writer_of(const Port& port) {
  return written_buffer(port.name, port.glsl_type, port.doc);
}

constexpr Port optional(Port port) {
  port.optional = true;
  return port;
}
// See Port::own_texels.
constexpr Port own_texels(Port port) {
  port.own_texels = true;
  return port;
}

// See Port::internally_ordered.
constexpr Port internally_ordered(Port port) {
  port.internally_ordered = true;
  return port;
}

// See Port::filtered.
constexpr Port filtered(Port port) {
  port.filtered = true;
  return port;
}

// See AccessExtent. Passes over a list need no where_covered.
constexpr Port where_covered(Port port) {
  port.extent = AccessExtent::covered;
  return port;
}
constexpr Port where_flagged(Port port) {
  port.extent = AccessExtent::flagged;
  return port;
}
template <size_t N> constexpr std::array<Port, N> at_few_texels(std::array<Port, N> ports) {
  for (Port& port : ports)
    port.extent = AccessExtent::few;
  return ports;
}

// See Port::bytes_per_tile.
constexpr Port with_bytes_per_tile(Port port, uint32_t bytes) {
  port.bytes_per_tile = bytes;
  return port;
}

// Inputs of the host.
inline constexpr Port lighting =
    sampled("lighting", "diffuse irradiance before albedo, linear", color_formats);
inline constexpr Port material = sampled_uint("material", "profile id per pixel; 0: no subsurface");
inline constexpr Port depth =
    sampled("depth", "device depth or view-space distance, as stated in dermis_frame.depth_kind");
inline constexpr Port scatter_scale =
    optional(sampled("scatter_scale", "factor on d per pixel; 0: diffuse; unbound: 1"));
inline constexpr Port albedo =
    optional(sampled("albedo", "diffuse albedo, linear; unbound: 1", color_formats));
inline constexpr Port velocity =
    optional(sampled("velocity",
                     "current minus previous position in pixels (right, down), without jitter; "
                     "optional third channel: "
                     "change of view depth that camera motion does not explain, in world units. "
                     "Unbound: the scene is "
                     "static",
                     way_formats));
inline constexpr Port importance = optional(
    sampled("importance", "importance of errors to the host, 0 to 1; unbound: 1 everywhere",
            importance_formats));

// Tiles of 8x8 pixels.
inline constexpr Port classes = read_buffer("classes", "uint", "output of subsurface.classify");
inline constexpr Port tiles =
    read_buffer("tiles", "uint",
                "element 0: number of tiles; then packed tiles: x in bits 0-14, y in bits 15-29, "
                "bit 30: all pixels have subsurface, bit 31: copy only");
inline constexpr Port arguments{"arguments", Usage::indirect_arguments, false, "uint",
                                "group counts x, y, z of an indirect dispatch over the tiles"};
inline constexpr Port list_state{
    "list_state", Usage::storage_buffer_update, false, "uint",
    "state of the groups that append to a list: subsurface.classify sets its first 8 words to 0, "
    "and a list leaves them at 0"};
inline constexpr Port tile_errors = read_buffer(
    "tile_errors", "uint", "per tile of the render rectangle: expected error; 0: no error");
inline constexpr Port tile_d =
    read_buffer("tile_d", "uint", "per tile of the render rectangle: bits of the widest d, px");
inline constexpr Port samples_per_tile = read_buffer(
    "samples_per_tile", "uint", "per tile of the render rectangle: allocated sample steps, 0 to 3");
inline constexpr Port tile_states = read_buffer(
    "tile_states", "uint",
    "per tile of the render rectangle: 0: not selected; 1: fades out; 2: shows scattered light; "
    "255: does not scatter; from bit 8 on the level, 0 to 7, by which neighbours read blurred "
    "light. Then the fraction of the budget for tiles that do not fade");
inline constexpr Port states_before =
    optional(read_buffer("states_before", "uint", "tile_states of the previous frame"));
inline constexpr Port pixel_weights = written_buffer(
    "pixel_weights", "uint",
    "16 words per tile, written in selected tiles: fraction of scattered light of each pixel, row "
    "by row, in 240ths; 255: no subsurface");
inline constexpr Port pixel_weights_before =
    optional(read_buffer("pixel_weights_before", "uint", "pixel_weights of the previous frame"));

// Light before and after scattering.
inline constexpr Port combined =
    written("lighting", "written where there is subsurface, with alpha 1; unchanged elsewhere",
            color_formats);
inline constexpr Port light = sampled("light", "output of subsurface.setup", light_formats);
inline constexpr Port slope = sampled("slope", "output of subsurface.setup", way_formats);
inline constexpr Port scattered = written(
    "scattered", "scattered light where there is subsurface; undefined elsewhere", color_formats);
inline constexpr Port sampling =
    optional(written("sampling",
                     "for tools: samples of this frame; samples in the history or their mean "
                     "number; confidence or standard "
                     "deviation; 1 where the history belongs to another surface",
                     light_formats));
inline constexpr Port burley_ports[] = {
    light, slope, material, depth, scatter_scale, tiles, arguments, scattered,
};

// Levels of the plain pyramid.
inline constexpr std::string_view level_doc =
    "rgb: light times mask; a: mask, the fraction of the texel with subsurface";
constexpr Port level(std::string_view name) {
  return filtered(sampled(name, level_doc, light_formats));
}
inline constexpr std::array levels_1_to_8{level("level_1"), level("level_2"), level("level_3"),
                                          level("level_4"), level("level_5"), level("level_6"),
                                          level("level_7"), level("level_8")};

// Levels 0 to 5 of the surface-aware pyramid.
inline constexpr std::string_view sap_level_doc = "output of subsurface.sap_down";
constexpr Port sap_light(std::string_view name) {
  return sampled(name, sap_level_doc, sap_light_formats);
}
constexpr Port sap_surface(std::string_view name) {
  return sampled_uint(name, sap_level_doc, surface_formats);
}
inline constexpr std::array sap_levels{
    sap_light("light"),       sap_light("light_1"),     sap_light("light_2"),
    sap_light("light_3"),     sap_light("light_4"),     sap_light("light_5"),
    sap_surface("surface"),   sap_surface("surface_1"), sap_surface("surface_2"),
    sap_surface("surface_3"), sap_surface("surface_4"), sap_surface("surface_5")};
// Result of the surface-aware pyramid.
inline constexpr Port sap_scattered = sampled(
    "scattered", "output of the pyramid. rgb: scattered light; a: confidence", light_formats);

} // namespace port
} // namespace dermis::subsurface
