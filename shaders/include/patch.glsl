// The surface patch behind a pixel, from depth differences; mirrors passes/subsurface/truth/surface.cpp. Groups are 8x8
// pixels, which share what they read. Include after bindings with `material` and `depth`.
#ifndef DERMIS_PATCH_GLSL
#define DERMIS_PATCH_GLSL

#include "constants.glsl"
#include "environment.glsl"

const int patch_side = 10; // 8x8 pixels and a ring around them
shared uint patch_profile[patch_side * patch_side];
shared float patch_depth[patch_side * patch_side]; // mm, 0 where there is nothing

// Reads what the group with first pixel `first` needs, once each. Every invocation of the group calls it.
void share_patches(ivec2 first) {
  for (int i = int(gl_LocalInvocationIndex); i < patch_side * patch_side; i += 64) {
    ivec2 pixel = first + ivec2(i % patch_side, i / patch_side) - 1, texel = texel_of(pixel);
    uint id = inside_rect(pixel) ? texelFetch(material_image, texel, 0).r : 0u;
    patch_profile[i] = id;
    patch_depth[i] = id != 0u ? view_depth(texelFetch(depth_image, texel, 0).r) : 0.0;
  }
  barrier();
}
int patch_index(ivec2 offset) {
  ivec2 local = ivec2(gl_LocalInvocationID.xy) + 1 + offset;
  return local.y * patch_side + local.x;
}
uint own_profile() { return patch_profile[patch_index(ivec2(0))]; }
float own_depth() { return patch_depth[patch_index(ivec2(0))]; }

// Depth of the pixel at an offset if it is of profile `id`, mm; 0 if it is outside, of another profile or has none.
float depth_of_profile(ivec2 offset, uint id) {
  int index = patch_index(offset);
  return patch_profile[index] == id ? patch_depth[index] : 0.0;
}

// Tangent along an axis: towards the neighbour of the same profile that is nearer in depth; across the view where
// there is none.
vec3 patch_tangent(ivec2 pixel, ivec2 axis, uint id, float depth, vec3 position) {
  float after = depth_of_profile(axis, id), before = depth_of_profile(-axis, id);
  bool backwards = before > 0.0 && (after <= 0.0 || abs(before - depth) < abs(after - depth));
  float neighbour = backwards ? before : (after > 0.0 ? after : depth);
  int side = backwards ? -1 : 1;
  return float(side) * (view_position(vec2(pixel + side * axis), neighbour) - position);
}

struct surface_patch {
  vec2 slope;  // d depth / d pixel, in footprints per pixel
  float area;  // over the area of the pixel's cross-section: 1 / cos to the viewer, capped
};

// Of the invocation's own pixel, after share_patches.
surface_patch build_patch(ivec2 pixel) {
  uint id = own_profile();
  float depth = own_depth();
  vec3 position = view_position(vec2(pixel), depth);
  vec3 ray = is_perspective() ? position / depth : vec3(0.0, 0.0, -1.0);
  vec3 viewer = -normalize(ray);
  vec3 normal = cross(patch_tangent(pixel, ivec2(1, 0), id, depth, position),
                      patch_tangent(pixel, ivec2(0, 1), id, depth, position));
  float size = length(normal);
  normal = size > 0.0 ? normal / size : viewer;
  if (dot(normal, viewer) < 0.0)
    normal = -normal;
  float cosine = dot(normal, viewer);
  if (cosine < min_patch_cosine) { // tilt towards the viewer until it meets the limit
    vec3 across = normal - viewer * cosine;
    float across_size = length(across);
    normal = across_size > 0.0
                 ? across * (sqrt(1.0 - min_patch_cosine * min_patch_cosine) / across_size) + viewer * min_patch_cosine
                 : viewer;
    cosine = max(dot(normal, viewer), min_patch_cosine);
  }
  surface_patch result;
  // The plane dot(normal, P) = const, P = depth * (scale * pixel + offset, -1), differentiated by pixel; an
  // orthographic ray has no depth in its x and y, which leaves the same quotient.
  vec2 signs = sign(frame.ray_scale);
  result.slope = is_perspective() ? -normal.xy * signs / dot(normal, ray) : normal.xy * signs / normal.z;
  result.area = 1.0 / cosine;
  return result;
}

#endif
