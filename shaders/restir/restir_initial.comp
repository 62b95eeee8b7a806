#version 460
// Samples paths camera - x1 - x2 - light: x2 by a probe ray, one place on one light, one shadow
// ray. Resampling selects one of several paths.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#extension GL_EXT_ray_query : require
#include "restir/instances.glsl"
#include "restir/lights.glsl"
#include "restir/restir_initial.bindings.glsl"
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

void main() {
  ivec2 pixel;
  bool copy_only;
  uint listed = listed_tile();
  if (listed >= tiles_data[0] || !pixel_of_tile(tiles_data[1u + listed], pixel, copy_only))
    return;
  scatter_domain domain = domain_of(pixel);
  random_state random = random_of(pixel, random_numbers_of_samples);
  reservoir_stream stream = stream_begin();
  float fraction = 1.0 / float(settings.samples); // MIS weight of equal techniques
  for (int i = 0; i < settings.samples; ++i) {
    reservoir candidate = draw_initial(domain, random);
    float target =
        has_sample(candidate) ? target_of(domain, surface_of(candidate), candidate) : 0.0;
    stream_add(stream, candidate, target, fraction * target * candidate.weight, fraction,
               random_unit(random));
  }
  packed_reservoir packed = pack_reservoir(stream_end(stream));
  for (uint i = 0u; i < 4u; ++i)
    reservoirs_data[4u * element_of(pixel) + i] = packed.words[i];
}
