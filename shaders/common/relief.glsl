// How much of the surface around a pixel leaves the pixel's tangent plane. Mirrors
// passes/common/reference/relief.cpp.
#ifndef DERMIS_RELIEF_GLSL
#define DERMIS_RELIEF_GLSL

#extension GL_EXT_samplerless_texture_functions : require

#include "constants.glsl"
#include "common/environment.glsl"
#include "common/radius.glsl"

// Half of the groups of subsurface.classify count relief.
bool counts_relief_in(uvec2 group) { return (group.x + group.y & 1u) == 0u; }

struct surface_sample {
  float depth; // mm; 0: no depth, or outside
  uint id;     // 0: no subsurface, or outside
};
surface_sample sample_surface(utexture2D material, texture2D depth, ivec2 pixel) {
  if (!inside_rect(pixel))
    return surface_sample(0.0, 0u);
  ivec2 texel = texel_of(pixel);
  return surface_sample(view_depth(texelFetch(depth, texel, 0).r),
                        profile_of(texelFetch(material, texel, 0).r));
}

// Returns a function of depth that is linear in the pixel on a plane.
float linear_depth(float depth) { return is_perspective() ? 1.0 / depth : depth; }

// Returns the change of linear_depth per pixel along an axis, towards the neighbour of the same
// profile that is nearer in depth; 0 if that neighbour is on another surface.
float depth_gradient(utexture2D material, texture2D depth, ivec2 pixel, ivec2 axis,
                     surface_sample own, float side) {
  surface_sample before = sample_surface(material, depth, pixel - axis),
                 after = sample_surface(material, depth, pixel + axis);
  float back = before.id == own.id && before.depth > 0.0 ? abs(before.depth - own.depth) : 1e30,
        forth = after.id == own.id && after.depth > 0.0 ? abs(after.depth - own.depth) : 1e30;
  if (min(back, forth) > max_patch_slope * side)
    return 0.0;
  return back < forth ? linear_depth(own.depth) - linear_depth(before.depth)
                      : linear_depth(after.depth) - linear_depth(own.depth);
}

// Returns how far the surface at an offset (pixels) is off the tangent plane: 0 on it, 1 far off,
// and less again where it is too far off to receive light; -1: no subsurface there.
float relief_at(utexture2D material, texture2D depth, ivec2 pixel, surface_sample own,
                vec2 gradient, ivec2 offset, float d_mm) {
  surface_sample other = sample_surface(material, depth, pixel + offset);
  if (other.id == 0u || other.depth <= 0.0)
    return -1.0;
  float plane = linear_depth(own.depth) + dot(gradient, vec2(offset));
  if (is_perspective())
    plane = 1.0 / max(plane, 1e-6 / own.depth);
  float off = abs(other.depth - plane);
  float steepness = off / (length(vec2(offset) * pixel_footprint(own.depth)) * relief_width);
  return (1.0 - exp(-0.5 * steepness * steepness)) * exp(-off / (relief_range_d * d_mm));
}

// Returns the mean of relief_at over two points around a pixel, in directions that follow from
// `turn`; -1: neither has subsurface, or the pixel scatters less than a pixel far. `scale`: the
// pixel's factor on d.
float relief_of(utexture2D material, texture2D depth, ivec2 pixel, uint turn, float scale) {
  surface_sample own = sample_surface(material, depth, pixel);
  float d_mm = profiles[min(own.id, 255u)].d_mm.w * scale;
  if (own.depth <= 0.0 || !(projected_d(d_mm, own.depth) >= copy_below_d_px))
    return -1.0;
  vec2 side = pixel_footprint(own.depth);
  vec2 gradient = vec2(depth_gradient(material, depth, pixel, ivec2(1, 0), own, side.x),
                       depth_gradient(material, depth, pixel, ivec2(0, 1), own, side.y));
  float sum = 0.0, count = 0.0;
  for (uint i = 0u; i < 2u; ++i) {
    float angle = relief_turn * float(2u * turn + i);
    vec2 offset =
        (i == 0u ? relief_far_d : relief_near_d) * d_mm * vec2(cos(angle), sin(angle)) / side;
    offset *= max(1.0, 1.0 / max(length(offset), 1e-6));
    offset = clamp(offset, vec2(-relief_max_offset), vec2(relief_max_offset));
    float relief = relief_at(material, depth, pixel, own, gradient, ivec2(round(offset)), d_mm);
    sum += max(relief, 0.0);
    count += relief >= 0.0 ? 1.0 : 0.0;
  }
  return count > 0.0 ? sum / count : -1.0;
}

#endif
