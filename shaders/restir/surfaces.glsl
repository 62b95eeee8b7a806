// Surfaces of the host's scene, from its buffers. Lengths are in the host's units. GLSL cannot pass
// buffers to functions, so this file declares functions that read them, and the kernel defines
// these.
#ifndef DERMIS_RESTIR_SURFACES_GLSL
#define DERMIS_RESTIR_SURFACES_GLSL

#extension GL_EXT_samplerless_texture_functions : require

#include "common/environment.glsl"
#include "common/profile.glsl"
#include "restir/instances.glsl"
#include "restir/random.glsl"
#include "restir/scene.glsl"
#include "common/radius.glsl"
#include "common/sanitise.glsl"

// Elements of the ports instances, indices and vertices.
ray_instance instance_at(uint index);
uint index_at(uint index);
vec4 vertex_at(uint index);

vec3 world_position(ray_instance one, uint vertex) {
  vec4 at = vec4(vertex_at(2u * (one.place.x + vertex)).xyz, 1.0);
  return vec3(dot(one.world_from_object[0], at), dot(one.world_from_object[1], at),
              dot(one.world_from_object[2], at));
}

surface_point surface_at(uint instance, uint primitive, vec2 barycentrics) {
  ray_instance one = instance_at(instance);
  vec3 fraction = vec3(1.0 - barycentrics.x - barycentrics.y, barycentrics);
  vec3 p[3], normal = vec3(0.0);
  for (uint i = 0u; i < 3u; ++i) {
    uint vertex = index_at(one.place.y + 3u * primitive + i);
    p[i] = world_position(one, vertex);
    normal += fraction[i] * vertex_at(2u * (one.place.x + vertex) + 1u).xyz;
  }
  vec3 geometric = normalize(cross(p[1] - p[0], p[2] - p[0]));
  vec3 x = one.world_from_object[0].xyz, y = one.world_from_object[1].xyz,
       z = one.world_from_object[2].xyz;
  // multiplies by the matrix of cofactors
  vec3 shading = vec3(dot(cross(y, z), normal), dot(cross(z, x), normal), dot(cross(x, y), normal));
  if (dot(x, cross(y, z)) < 0.0) { // mirroring turns an object inside out
    geometric = -geometric;
    shading = -shading;
  }
  float square = dot(shading, shading);
  return surface_point(fraction.x * p[0] + fraction.y * p[1] + fraction.z * p[2], geometric,
                       square > 0.0 ? shading * inversesqrt(square) : geometric,
                       profile_of(one.place.z));
}

float mm_per_world_unit() { return length(frame.view_from_world[0].xyz); }

vec3 world_direction(vec3 in_view) {
  return (in_view.x * frame.view_from_world[0].xyz + in_view.y * frame.view_from_world[1].xyz +
          in_view.z * frame.view_from_world[2].xyz) /
         mm_per_world_unit();
}

// Returns the scatter domain of a pixel; d is 0 if nothing scatters. `scatter_scale` is not read
// unless `scale_bound`.
scatter_domain domain_of(utexture2D material, texture2D depth_texture, texture2D normal_texture,
                         texture2D scatter_scale, bool scale_bound, ivec2 pixel) {
  ivec2 texel = texel_of(pixel);
  uint id = profile_of(texelFetch(material, texel, 0).r);
  float depth = view_depth(texelFetch(depth_texture, texel, 0).r);
  vec3 normal = view_normal(texelFetch(normal_texture, texel, 0).xyz);
  float square = dot(normal, normal);
  if (id == 0u || !(depth > 0.0) || !(square > 1e-30 && square < 3e38)) // no direction: no surface
    return scatter_domain(vec3(0.0), vec3(0.0, 0.0, 1.0), vec3(0.0), 0u);
  float scale = scale_bound ? clean_scatter_scale(texelFetch(scatter_scale, texel, 0).r) : 1.0;
  if (!(projected_d(find_profile(id, scale).d.w, depth) >= copy_below_d_px))
    return scatter_domain(vec3(0.0), vec3(0.0, 0.0, 1.0), vec3(0.0), 0u);
  vec3 from_eye =
      view_position(vec2(pixel), depth) -
      vec3(frame.view_from_world[0].w, frame.view_from_world[1].w, frame.view_from_world[2].w);
  return scatter_domain(world_direction(from_eye) / mm_per_world_unit(),
                        normalize(world_direction(normal * inversesqrt(square))),
                        find_profile(id, scale).d.rgb / mm_per_world_unit(), id);
}

// Returns the index of a pixel of the rectangle in buffers with one element per pixel, row by row.
// The size of the host's images does not matter.
uint element_of(ivec2 pixel) { return uint(pixel.y * frame.rect.z + pixel.x); }

random_state random_of(ivec2 pixel, uint first) {
  return random_state(uint(pixel.x) | uint(pixel.y) << 16, frame.frame_index, first);
}

#endif
