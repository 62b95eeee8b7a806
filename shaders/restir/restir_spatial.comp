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

// The host's scene.
ray_instance instance_at(uint index) { return instances_data[index]; }
uint index_at(uint index) { return indices_data[index]; }
vec4 vertex_at(uint index) { return vertices_data[index]; }
uint light_count() { return uint(lights_data.length()); }
light_source light_at(uint index) { return lights_data[index]; }
// Paths to neighbours keep their light or are lit by the lights of this frame.
light_source previous_light_at(uint index) { return light_at(index); }
rayQueryEXT query;
chosen_hit trace_probe(probe_ray ray, uint medium, hit_choice choice) {
  return trace_probe(scene_structure, query, ray, medium, choice);
}
bool visible(surface_point from, vec3 target) {
  return visible(scene_structure, query, from, target);
}

scatter_domain domain_of(ivec2 pixel) {
  return domain_of(material_image, depth_image, normal_image, scatter_scale_image,
                   has_scatter_scale(), pixel);
}

reservoir reservoir_of(ivec2 pixel) {
  packed_reservoir packed;
  for (uint i = 0u; i < 4u; ++i)
    packed.words[i] = reservoirs_data[4u * element_of(pixel) + i];
  return unpack_reservoir(packed);
}

// Returns whether the pixel wrote a reservoir of the same profile in this frame.
bool is_neighbour(ivec2 pixel, uint medium) {
  if (medium == 0u || !inside_rect(pixel))
    return false;
  ivec2 tile = pixel >> 3;
  return class_of_tile(classes_data[tile.y * frame.tiles.x + tile.x]) != class_none &&
         profile_of(texelFetch(material_image, texel_of(pixel), 0).r) == medium;
}

// Tests pixels around `pixel` until one is a neighbour. `tested` counts them; at most
// settings.neighbours are tested.
bool next_neighbour(ivec2 pixel, uint medium, float radius, inout int tested,
                    inout random_state random, out ivec2 neighbour) {
  while (tested < settings.neighbours) {
    ++tested;
    neighbour = pixel + neighbour_offset(radius, random);
    if (neighbour != pixel && is_neighbour(neighbour, medium))
      return true;
  }
  return false;
}

void main() {
  ivec2 pixel;
  bool copy_only;
  uint listed = listed_tile();
  if (listed >= tiles_data[0] || !pixel_of_tile(tiles_data[1u + listed], pixel, copy_only))
    return;
  scatter_domain domain = domain_of(pixel);
  uint stage = settings.pass == 0 ? stage_spatial_first : stage_spatial_second;
  random_state random = random_of(pixel, (1u + stage) * random_numbers_a_pass);
  vec2 footprint = pixel_footprint(view_depth(texelFetch(depth_image, texel_of(pixel), 0).r)) /
                   mm_per_world_unit();
  float radius = search_radius(domain.d, min(footprint.x, footprint.y));

  // The neighbours are found twice instead of kept in an array.
  random_state again = random;
  ivec2 other;
  float confidences = 0.0;
  int tested = 0;
  while (tested < settings.neighbours)
    if (next_neighbour(pixel, domain.medium, radius, tested, random, other))
      confidences += reservoir_of(other).confidence;
  reuse_settings reuse =
      reuse_settings(shift_of_stage(uint(settings.shift), stage), index_traced, confidence_cap);
  spatial_merge spatial = spatial_begin(domain, reservoir_of(pixel), confidences);
  tested = 0;
  for (bool ended = false; !ended;) {
    spatial_move(reuse, spatial, random);
    if (spatial.move == move_back) {
      ended = !next_neighbour(pixel, domain.medium, radius, tested, again, other);
      if (!ended)
        spatial_neighbour(spatial, domain_of(other), reservoir_of(other));
    }
  }
  packed_reservoir merged = pack_reservoir(spatial_end(spatial, random));
  for (uint i = 0u; i < 4u; ++i)
    merged_data[4u * element_of(pixel) + i] = merged.words[i];
}
