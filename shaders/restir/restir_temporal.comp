#version 460
// Merges each pixel's path with the path that its surface had in the previous frame, and keeps the
// domains and the lights for the next frame.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_EXT_ray_query : require
#include "restir/instances.glsl"
#include "restir/lights.glsl"
#include "restir/restir_temporal.bindings.glsl"
#include "common/environment.glsl"
#include "common/tiles.glsl"
#include "restir/rays.glsl"
#include "restir/reuse.glsl"
#include "common/reproject.glsl"

// The host's scene.
ray_instance instance_at(uint index) { return instances_data[index]; }
uint index_at(uint index) { return indices_data[index]; }
vec4 vertex_at(uint index) { return vertices_data[index]; }
uint light_count() { return uint(lights_data.length()); }
light_source light_at(uint index) { return lights_data[index]; }
// A light without a kept copy is returned as it is now.
light_source previous_light_at(uint index) {
  light_source light = light_at(index);
  if (index < uint(lights_before_data.length())) // an if instead of ?:, because the layouts differ
    light = lights_before_data[index];
  return light;
}
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

void keep_lights() {
  if (gl_WorkGroupID.x + gl_WorkGroupID.y != 0u)
    return;
  for (uint i = gl_LocalInvocationIndex; i < uint(lights_kept_data.length()); i += 64u) {
    // a dark light
    light_source light =
        light_source(vec3(0.0), light_point, vec3(0.0), 0.0, vec3(0.0), 1.0, vec3(0.0), 1.0);
    if (i < light_count())
      light = light_at(i);
    lights_kept_data[i] = light;
  }
}

uint element_before(ivec2 pixel) { return uint(pixel.y * frame.previous_rect.z + pixel.x); }

scatter_domain domain_before(ivec2 pixel) {
  packed_domain packed;
  for (uint i = 0u; i < 2u; ++i)
    packed.words[i] = domains_before_data[2u * element_before(pixel) + i];
  return unpack_domain(packed);
}

vec2 surface_before(ivec2 pixel) {
  scatter_domain domain = domain_before(pixel);
  vec4 world = vec4(domain.position, 1.0);
  vec4 view = vec4(dot(frame.view_from_world[0], world), dot(frame.view_from_world[1], world),
                   dot(frame.view_from_world[2], world), 1.0);
  return vec2(-dot(frame.previous_from_view[2], view), float(domain.medium));
}

history_taps find_history(previous_position place, uint id, float tolerance) {
  history_taps taps = taps_around(place);
  for (int i = 0; i < 4; ++i)
    if (taps.weight[i] > 0.0 &&
        !shows_surface(surface_before(tap_pixel(taps, i)), place, id, tolerance))
      taps.weight[i] = 0.0;
  return normalised_taps(taps);
}

// Returns the change of the surface's depth over a pixel, mm.
float rise_over_pixel(ivec2 pixel, float depth) {
  vec3 normal = normalize(view_normal(texelFetch(normal_image, texel_of(pixel), 0).xyz));
  vec3 way = is_perspective() ? normalize(view_position(vec2(pixel), depth)) : vec3(0.0, 0.0, -1.0);
  float cosine = clamp(abs(dot(normal, way)), min_patch_cosine, 1.0);
  vec2 footprint = pixel_footprint(depth);
  return max(footprint.x, footprint.y) * sqrt(1.0 - cosine * cosine) / cosine;
}

// Selects one of the texels around the surface's previous place, by their weights. Returns false if
// the surface was not visible.
bool find_past(ivec2 pixel, uint id, float u, out ivec2 past) {
  past = ivec2(0);
  if (!history_usable())
    return false;
  float depth = view_depth(texelFetch(depth_image, texel_of(pixel), 0).r);
  previous_position place =
      has_velocity()
          ? reproject(vec2(pixel), depth, texelFetch(velocity_image, texel_of(pixel), 0).rgb)
          : reproject(vec2(pixel), depth);
  history_taps taps =
      find_history(place, id, depth_tolerance(place.depth, rise_over_pixel(pixel, depth)));
  bool found = false;
  for (int i = 0; i < 4; ++i) {
    if (!(taps.weight[i] > 0.0))
      continue;
    found = true;
    past = tap_pixel(taps, i);
    if (u < taps.weight[i])
      break;
    u -= taps.weight[i];
  }
  return found;
}

// Returns whether the scene has the path's triangle, in a surface of `medium`. Objects may have
// been removed since the previous frame.
bool is_in_scene(reservoir path, uint medium) {
  if (path.instance >= uint(instances_data.length()))
    return false;
  uvec4 place = instances_data[path.instance].place;
  uint indices = uint(indices_data.length()), vertices = uint(vertices_data.length()) / 2u;
  if (profile_of(place.z) != medium || place.y > indices ||
      path.primitive >= (indices - place.y) / 3u)
    return false;
  bool inside = place.x < vertices;
  for (uint i = 0u; i < 3u; ++i)
    inside = inside && index_at(place.y + 3u * path.primitive + i) < vertices - place.x;
  return inside;
}

void main() {
  keep_lights();
  ivec2 pixel;
  bool copy_only;
  uint listed = listed_tile();
  if (listed >= tiles_data[0] || !pixel_of_tile(tiles_data[1u + listed], pixel, copy_only))
    return;
  uint element = element_of(pixel);
  scatter_domain domain = domain_of(pixel);
  packed_domain kept = pack_domain(domain);
  for (uint i = 0u; i < 2u; ++i)
    domains_data[2u * element + i] = kept.words[i];
  packed_reservoir own, before;
  for (uint i = 0u; i < 4u; ++i)
    own.words[i] = reservoirs_data[4u * element + i];
  random_state random = random_of(pixel, random_numbers_a_pass);
  ivec2 past;
  if (domain.medium != 0u && find_past(pixel, domain.medium, random_unit(random), past)) {
    for (uint i = 0u; i < 4u; ++i)
      before.words[i] = reservoirs_before_data[4u * element_before(past) + i];
    reuse_settings reuse = reuse_settings(shift_of_stage(uint(settings.shift), stage_temporal),
                                          index_traced, settings.cap);
    reservoir previous = unpack_reservoir(before);
    if (!is_in_scene(previous, domain.medium))
      previous = no_reservoir(previous.confidence);
    own = pack_reservoir(merge_temporal(reuse, domain, unpack_reservoir(own), domain_before(past),
                                        previous, random));
  }
  for (uint i = 0u; i < 4u; ++i)
    merged_data[4u * element + i] = own.words[i];
}
