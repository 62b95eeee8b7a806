// Range of the light of a tile, or of a cell of 4x4 tiles, in a uvec4. x, y, z: minimum and maximum
// of red, green and blue as halves, to which the light was rounded. w: the widest d in pixels, as
// bits. A minimum above the maximum means no subsurface.
#ifndef DERMIS_LIGHT_RANGE_GLSL
#define DERMIS_LIGHT_RANGE_GLSL

#include "constants.glsl"

uvec4 pack_range(vec3 low, vec3 high, float d_px) {
  return uvec4(packHalf2x16(vec2(low.r, high.r)), packHalf2x16(vec2(low.g, high.g)),
               packHalf2x16(vec2(low.b, high.b)), floatBitsToUint(d_px));
}

// Returns a range that is not similar to any other light.
uvec4 any_light() { return pack_range(vec3(0.0), vec3(65504.0), 0.0); }

void unpack_range(uvec4 range, out vec3 low, out vec3 high) {
  vec2 r = unpackHalf2x16(range.x), g = unpackHalf2x16(range.y), b = unpackHalf2x16(range.z);
  low = vec3(r.x, g.x, b.x);
  high = vec3(r.y, g.y, b.y);
}

// Returns how many tiles light reaches to each side of a tile with this d. In Burley's profile,
// less than 0.1 % of the light goes further.
int uniform_reach(float d_px) { return int(ceil(uniform_reach_d * d_px / 8.0)); }

// Returns whether all of `range` is within the tolerance of the light between `low` and `high`. The
// result then also holds for every range inside `range`.
bool is_alike(uvec4 range, vec3 low, vec3 high) {
  vec3 other_low, other_high;
  unpack_range(range, other_low, other_high);
  if (other_low.r > other_high.r) // no subsurface
    return true;
  return all(lessThanEqual(max(high, other_high) - min(low, other_low), uniform_tolerance * high));
}

#endif
