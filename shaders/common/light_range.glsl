// Between which values the light of a tile lies, or of a cell of 4x4 tiles, in a uvec4: x, y, z = the least and the greatest of red, green, blue as
// halves, which the light was rounded to; w = the widest d in pixels, as bits. The least above the greatest: no
// subsurface.
#ifndef DERMIS_LIGHT_RANGE_GLSL
#define DERMIS_LIGHT_RANGE_GLSL

#include "constants.glsl"

uvec4 pack_range(vec3 low, vec3 high, float d_px) {
  return uvec4(packHalf2x16(vec2(low.r, high.r)), packHalf2x16(vec2(low.g, high.g)), packHalf2x16(vec2(low.b, high.b)),
               floatBitsToUint(d_px));
}

// Light that nothing is alike.
uvec4 any_light() { return pack_range(vec3(0.0), vec3(65504.0), 0.0); }

void unpack_range(uvec4 range, out vec3 low, out vec3 high) {
  vec2 r = unpackHalf2x16(range.x), g = unpackHalf2x16(range.y), b = unpackHalf2x16(range.z);
  low = vec3(r.x, g.x, b.x);
  high = vec3(r.y, g.y, b.y);
}

// Tiles that light reaches to each side of one with this d: what lies beyond weighs less than .1 % in Burley's profile.
int flat_reach(float d_px) { return int(ceil(flat_reach_d * d_px / 8.0)); }

// Is all of `range` within the tolerance of what lies between `low` and `high`? A range inside of one that is, is.
bool is_alike(uvec4 range, vec3 low, vec3 high) {
  vec3 other_low, other_high;
  unpack_range(range, other_low, other_high);
  if (other_low.r > other_high.r) // no subsurface
    return true;
  return all(lessThanEqual(max(high, other_high) - min(low, other_low), flat_tolerance * high));
}

#endif
