#version 460
// Merges each pixel's path with the paths of surrounding pixels that show the same profile.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_EXT_ray_query : require
#include "restir/instances.glsl"
#include "restir/lights.glsl"
#include "restir/restir_spatial.bindings.glsl"
#include "common/environment.glsl"
#include "common/tiles.glsl"
#include "restir/rays.glsl"
#include "restir/reuse.glsl"

const uint max_neighbours = 8u;

reservoir reservoir_of(ivec2 pixel) {
  packed_reservoir packed;
  for (uint i = 0u; i < 4u; ++i)
    packed.words[i] = reservoirs_data[4u * element_of(pixel) + i];
  return unpack_reservoir(packed);
}

// Returns whether the pixel wrote a reservoir of the same profile in this frame.
bool is_neighbour(ivec2 pixel, uint medium) {
  if (!inside_rect(pixel))
    return false;
  ivec2 tile = pixel >> 3;
  return class_of_tile(classes_data[tile.y * frame.tiles.x + tile.x]) != class_none &&
         texelFetch(material_image, texel_of(pixel), 0).r == medium;
}

void main() {
  ivec2 pixel;
  bool copy_only;
  if (!listed_pixel(pixel, copy_only))
    return;
  scatter_domain domain = domain_of(pixel);
  uint stage = settings.pass == 0 ? stage_spatial_first : stage_spatial_second;
  random_state random = random_of(pixel, (1u + stage) * random_numbers_a_pass);
  vec2 footprint = pixel_footprint(view_depth(texelFetch(depth_image, texel_of(pixel), 0).r)) / mm_per_world_unit();
  float radius = search_radius(domain.d, min(footprint.x, footprint.y));

  ivec2 neighbours[max_neighbours];
  uint count = 0u;
  float confidences = 0.0;
  for (int i = 0; i < settings.neighbours && domain.medium != 0u; ++i) {
    ivec2 other = pixel + neighbour_offset(radius, random);
    if (other == pixel || !is_neighbour(other, domain.medium))
      continue;
    neighbours[count++] = other;
    confidences += reservoir_of(other).confidence;
  }
  reuse_settings reuse = reuse_settings(shift_of_stage(uint(settings.shift), stage), index_traced, confidence_cap);
  spatial_merge spatial = spatial_begin(reuse, domain, reservoir_of(pixel), confidences, random);
  for (uint i = 0u; i < count; ++i)
    spatial_add(reuse, domain, spatial, domain_of(neighbours[i]), reservoir_of(neighbours[i]), random);
  packed_reservoir merged = pack_reservoir(spatial_end(spatial, random));
  for (uint i = 0u; i < 4u; ++i)
    merged_data[4u * element_of(pixel) + i] = merged.words[i];
}
