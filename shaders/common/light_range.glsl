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

// Returns the range of the light of both. A range without subsurface changes nothing.
uvec4 join_ranges(uvec4 a, uvec4 b) {
  // Halves that are not negative are ordered as their bits.
  uvec3 low = min(a.xyz & 0xffffu, b.xyz & 0xffffu);
  return uvec4(max(a.xyz, b.xyz) & 0xffff0000u | low, max(a.w, b.w));
}

// Returns how many tiles light reaches to each side of a tile with this d. In Burley's profile,
// less than 0.1 % of the light goes further.
int uniform_reach(float d_px) { return int(min(ceil(uniform_reach_d * d_px / 8.0), 1e6)); }

// Returns whether all of `range` is within the tolerance of the light between `low` and `high`. The
// result then also holds for every range inside `range`.
bool is_alike(uvec4 range, vec3 low, vec3 high) {
  vec3 other_low, other_high;
  unpack_range(range, other_low, other_high);
  if (other_low.r > other_high.r) // no subsurface
    return true;
  return all(lessThanEqual(max(high, other_high) - min(low, other_low), uniform_tolerance * high));
}

// Returns whether a tile of a cell with this range is certainly beyond the tolerance of the light
// between `low` and `high`: each end of the cell's range is that of one of the cell's tiles.
bool has_unlike(uvec4 cell, vec3 low, vec3 high) {
  vec3 cell_low, cell_high;
  unpack_range(cell, cell_low, cell_high);
  vec3 wide = max(max(high, cell_high) - low, high - min(low, cell_low));
  return cell_low.r <= cell_high.r && any(greaterThan(wide, uniform_tolerance * high));
}

#endif
