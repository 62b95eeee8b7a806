// Functions shared by the kernels of the surface-aware pyramid (SAP).
// tests/passes/sap/cpu/sap_cpu.cpp mirrors them.
#ifndef DERMIS_SAP_GLSL
#define DERMIS_SAP_GLSL

#extension GL_EXT_control_flow_attributes : require

#include "constants.glsl"
#include "common/environment.glsl"
#include "common/pixel_grid.glsl"

const float sap_sigma = 0.8660254; // standard deviation of [1 3 3 1] in its own spacings: sqrt(3)/2
// Widths of the weights in sigmas, by measurement (tests/passes/sap/cpu/sap_levels.hpp).
const float sap_depth_width = 2.0;      // distance from the tangent plane: stops at depth steps
// the same on the way up, if texels of the finer level are farther apart than that, in pixels
const float sap_depth_width_up = 2.1, sap_first_wide_spacing = 2.5;
// depth along the tangent plane: narrows the kernel on slopes
const float sap_tilt_width_down = 1.0;
const float sap_tilt_width_tent = 1.25;
const float sap_confidence_width = 0.87; // distance from the farther plane
const float sap_relevant_d = 6.0; // distance in d from which a missing surface does not matter
const float sap_negligible = 1e-12;
// Largest reach that a texel can store: a larger half becomes infinite when it drops two bits.
const float sap_max_reach = 65408.0;

// exp(-x^2 / (2 width^2)) = exp2(factor * x^2)
float sap_factor(float width) { return -0.5 * 1.44269504 / (width * width); }
// The same as exp2(-(rate * x)^2), where the unit of x takes the rate.
float sap_rate(float width) { return sqrt(0.5 * 1.44269504) / width; }
// Returns the smaller absolute distance. A texel's distance from the surface is the smaller of its
// distance from the tangent plane and its difference in depth.
float sap_nearer(float a, float b) { return min(abs(a), abs(b)); }

// Largest mass of a texel, on folded surfaces (sap_folds.glsl); 255 / sap_max_mass is whole.
const float sap_max_mass = 1.875;

struct sap_texel {
  float depth;  // mm; its last bits are sap_held()
  vec2 slope;   // change of depth per pixel, in footprints
  float reach;  // factor on d: cos^(1/8) to the viewer times the scatter scale
  float mass;   // fraction of the texel's own kernel that hit the surface; on folds up to
                // sap_max_mass
  uint id;      // profile, 0: no surface
};

// A texel is stored in two images, 20 bytes in total. Its light has four channels: rgb and the
// fourth root of the surface's area divided by its cross-section (a, from 1 to below 2). The image
// `light` holds r and g as halves. The image `surface` holds, from the lowest bit:
//   x: depth (float, not negative), whose last 7 bits are `held`: the fraction of the surface of
//      this profile under the texel that one of its layers represents, or that is too far off to
//      matter at the profile's d. Sign bit: the texel has a second layer; at level 0, the
//      pixel is next to another surface, and texels of level 1 that contain the pixel may have a
//      second layer
//   y: slope (halves); the last 4 bits of slope.x are `lost`: the fraction of surface under the
//      texel whose profile no layer has
//   z: light.b (half, 16 bits), light.a (half minus the half 1, 10 bits), 6 bits 0
//   w: mass (a half below 2 without its last 3 bits, 11 bits), reach (a half without its sign and
//      its last 2 bits, 13 bits), profile id (8 bits)
// Depth and slope.x are the nearest values that have these bits. With the setting `storage` = full,
// `light` holds all four channels as floats; light.a in `surface` is then sap_light_elsewhere.
const uint sap_second_bit = 0x80000000u;
const uint sap_half_1 = 0x3c000000u, sap_light_elsewhere = 0x03ff0000u;
const uint sap_max_held = 127u, sap_max_lost = 15u;
bool sap_has_second(uvec4 bits) { return (bits.x & sap_second_bit) != 0u; }

// Rounds the bits of a float to the nearest ones without the last `dropped`; ties to even.
uint sap_drop_bits(uint bits, int dropped) {
  return (bits + (1u << (dropped - 1)) - 1u + (bits >> dropped & 1u)) >> dropped;
}
// Returns the bits of the nearest float to `bits` whose last bits are `low`. `largest`: largest
// value of these bits.
uint sap_with_low_bits(uint bits, uint low, uint largest) {
  return (max(bits, low) - low + (largest + 1u) / 2u & ~largest) | low;
}
// Replaces held and lost, in units of 1 / sap_max_held and 1 / sap_max_lost.
uvec4 sap_with_held(uvec4 bits, uint held, uint lost) {
  bits.x = sap_with_low_bits(bits.x & ~sap_second_bit, held, sap_max_held) |
           bits.x & sap_second_bit;
  bits.y = sap_with_low_bits(bits.y & 0x7fffu, lost, sap_max_lost) | bits.y & 0xffff8000u;
  return bits;
}
// Returns `surface` of a texel with one layer, before sap_with_held(). Slope, mass and reach must
// be representable as halves. `light`: result of sap_pack_light.
uvec4 sap_pack(sap_texel t, uint light) {
  uint halves = packHalf2x16(vec2(t.mass, min(t.reach, sap_max_reach)));
  return uvec4(floatBitsToUint(t.depth), packHalf2x16(t.slope), light,
               max(sap_drop_bits(halves & 0xffffu, 3), 1u) | sap_drop_bits(halves >> 16, 2) << 11 |
                   t.id << 24);
}
// Returns the part of `surface` that holds light; `storage`: value of the setting.
uint sap_pack_light(vec4 light, bool full) {
  return full ? sap_light_elsewhere : packHalf2x16(vec2(light.b, max(light.a, 1.0))) - sap_half_1;
}
// Returns `held` in units of 1 / sap_max_held.
uint sap_held(sap_texel t) { return floatBitsToUint(t.depth) & sap_max_held; }
float sap_not_held(sap_texel t) { return 1.0 - float(sap_held(t)) / float(sap_max_held); }
float sap_lost(uvec4 bits) { return float(bits.y & sap_max_lost) / float(sap_max_lost); }
sap_texel sap_unpack(uvec4 bits) {
  float mass = unpackHalf2x16((bits.w & 0x7ffu) << 3).x;
  float reach = unpackHalf2x16(bits.w >> 9 & 0x7ffcu).x;
  return sap_texel(abs(uintBitsToFloat(bits.x)), unpackHalf2x16(bits.y), reach, mass,
                   bits.w >> 24);
}
// Returns light.b and light.a as halves, from `surface`.
uint sap_light_ba(uvec4 bits) { return bits.z & 0x03ffffffu | sap_half_1; }
// Returns the light of a texel from `surface` and its texel of `light`.
vec4 sap_light(uvec4 bits, vec4 stored, bool full) {
  return full ? stored : vec4(stored.rg, unpackHalf2x16(sap_light_ba(bits)));
}
// As sap_light, for kernels that do not know `storage`.
vec4 sap_light(uvec4 bits, vec4 stored) {
  return sap_light(bits, stored, (bits.z & sap_light_elsewhere) == sap_light_elsewhere);
}

// Level 0: a pixel with subsurface but without depth, whose light does not scatter. Mass without an
// id marks the pixel.
const sap_texel sap_flat = sap_texel(0.0, vec2(0.0), 0.0, 1.0, 0u);
bool sap_has_subsurface(sap_texel t) { return t.mass > 0.0; }

// Values that a level passes to the finer one: light of its own and coarser levels, the fraction of
// the kernel that hit the surface, and confidence: the fraction of the surface around that the
// levels represent.
struct sap_scattered {
  vec3 light;
  float confidence;
  vec3 mass;
};
// All values must be representable as halves.
uvec4 sap_pack_scattered(sap_scattered t) {
  return uvec4(packHalf2x16(t.light.rg), packHalf2x16(vec2(t.light.b, t.confidence)),
               packHalf2x16(t.mass.rg), packHalf2x16(vec2(t.mass.b, 0.0)));
}
sap_scattered sap_unpack_scattered(uvec4 bits) {
  vec2 pair = unpackHalf2x16(bits.y);
  return sap_scattered(vec3(unpackHalf2x16(bits.x), pair.x), pair.y,
                       vec3(unpackHalf2x16(bits.z), unpackHalf2x16(bits.w).x));
}

// Packs light as floats and the other values as a byte each, for kernels with the setting
// `storage`. A byte holds a mass of 1 exactly.
uvec4 sap_pack_scattered_full(sap_scattered t) {
  return uvec4(floatBitsToUint(t.light), packUnorm4x8(vec4(t.mass / sap_max_mass, t.confidence)));
}
sap_scattered sap_unpack_scattered_full(uvec4 bits) {
  vec4 fractions = unpackUnorm4x8(bits.w);
  return sap_scattered(uintBitsToFloat(bits.xyz), fractions.a, sap_max_mass * fractions.rgb);
}

// Values of the frame, read once per invocation and not again in every branch.
float sap_side = sqrt(abs(frame.ray_scale.x * frame.ray_scale.y));
float sap_side_per_depth = is_perspective() ? sap_side : 0.0;
float sap_side_at_any_depth = is_perspective() ? 0.0 : sap_side;
ivec2 sap_view_size = frame.rect.zw;

// Returns the geometric mean of a pixel's sides at a depth, mm.
float sap_footprint(float depth) { return depth * sap_side_per_depth + sap_side_at_any_depth; }
// Returns the rise of a texel's tangent plane at an offset in pixels, mm.
float sap_rise(float depth, vec2 slope, vec2 offset) {
  return dot(slope, offset) * sap_footprint(depth);
}

// Return the distance of a texel from another texel's surface in mm: the smaller of its distance
// from the tangent plane and its difference in depth. sap_off_planes considers the planes of both
// texels.
float sap_off_plane(sap_texel own, sap_texel tap, vec2 offset) {
  float depth_step = tap.depth - own.depth;
  return sap_nearer(depth_step - sap_rise(own.depth, own.slope, offset), depth_step);
}
float sap_off_planes(sap_texel own, sap_texel tap, vec2 offset) {
  return sap_nearer(sap_off_plane(own, tap, offset),
                    tap.depth - own.depth - sap_rise(tap.depth, tap.slope, offset));
}
// Returns 1 / the distance in sigmas of a level from which a surface does not matter to a texel.
float sap_per_relevant(sap_texel own, float spacing) {
  float d = max(profiles[min(own.id, 255u)].d_mm.a * own.reach, 1e-6);
  return sap_sigma * spacing * sap_footprint(own.depth) / (sap_relevant_d * d);
}
// Returns how much a surface matters at a distance in units of that one.
float sap_relevance(float off) { return clamp(1.0 - off, 0.0, 1.0); }

ivec2 sap_level_size(int level) {
  ivec2 halvings = halvings_of_level(level);
  return (sap_view_size + (ivec2(1) << halvings) - 1) >> halvings;
}
// Return the distance of a level's texels in pixels, and the geometric mean of both axes.
vec2 sap_spacings(int level) { return vec2(ivec2(1) << halvings_of_level(level)); }
float sap_spacing(int level) {
  ivec2 halvings = halvings_of_level(level);
  return square_pixels ? float(1 << level) : exp2(0.5 * float(halvings.x + halvings.y));
}
// Levels from 1 on have a border of one texel; level 0 has the layout of the view.
// Returns whether a texel that is not in front of the level is inside it.
bool sap_before_end(ivec2 at, int level) {
  return all(lessThan(at, sap_level_size(level) + (level > 0 ? 1 : 0)));
}
bool sap_inside(ivec2 at, int level) {
  int border = level > 0 ? 1 : 0;
  return all(bvec4(greaterThanEqual(at, ivec2(-border)),
                   lessThan(at, sap_level_size(level) + border)));
}
// Returns the tile of the view that contains a pixel. Level 0 is written only in tiles with
// subsurface. Coarser levels write the texels that contain such a pixel.
int sap_tile(ivec2 pixel) { return (pixel.y >> 3) * frame.tiles.x + (pixel.x >> 3); }
ivec2 sap_address(ivec2 at, int level) { return level > 0 ? at + 1 : texel_of(at); }

// Returns log2 of the aspect of the first texels that both axes halve, from the frame's pixels:
// positive if they are longer along the axis that the plan expects, or along any axis if no level
// halves one axis only.
float sap_log2_aspect() {
  float octaves = log2(abs(frame.ray_scale.x / frame.ray_scale.y));
  octaves = higher_pixels ? -octaves : octaves;
  return pixel_doublings == 0 ? abs(octaves) : octaves - float(pixel_doublings);
}
// Returns the position of the frame's pixels among the shapes with tables
// (passes/sap/sap_weights.hpp).
int sap_last_shape_node() {
  return pixel_doublings == 0 ? sap_shape_nodes / 2 : sap_shape_nodes - 1;
}
float sap_shape_node() {
  float first = pixel_doublings == 0 ? 0.0 : -sap_last_log2_aspect;
  return clamp((sap_log2_aspect() - first) / sap_log2_aspect_step, 0.0,
               float(sap_last_shape_node()));
}

// Returns rows 2 * pair and 2 * pair + 1 of a table at d px, as sap_lookup of
// passes/sap/sap_weights.cpp.
vec2 sap_lookup_pair(int table, int pair, float d_px) {
  float position = (log2(max(d_px, 1e-30)) - sap_log2_d_first) * sap_nodes_per_octave;
  float clamped = clamp(position, 0.0, float(sap_nodes - 1));
  int node = min(int(clamped), sap_nodes - 2);
  vec4 nodes = sap_table[(table * sap_table_pairs + pair) * sap_nodes + node];
  vec2 values = mix(nodes.xy, nodes.zw, clamped - float(node));
  // Below the first node, the weight of the centre rises to 1 and that of the tent falls to 0.
  float fraction = position < 0.0 ? d_px / exp2(sap_log2_d_first) : 1.0;
  return pair == 0 ? vec2(1.0 - fraction * (1.0 - values.x), fraction * values.y) : values;
}
// A profile with its own tables has one table per channel.
ivec3 sap_tables_of(uint id, int variant) {
  int own = int(profiles[min(id, 255u)].sap_table);
  return own == 0 ? ivec3(variant) : own + 3 * variant + ivec3(0, 1, 2);
}
// Returns rows 2 * pair and 2 * pair + 1 of a variant's tables per channel.
void sap_lookup_pairs(uint id, int variant, int pair, vec3 d_px, out vec3 even, out vec3 odd) {
  ivec3 table = sap_tables_of(id, variant);
  vec2 r = sap_lookup_pair(table.r, pair, d_px.r), g = sap_lookup_pair(table.g, pair, d_px.g),
       b = sap_lookup_pair(table.b, pair, d_px.b);
  even = vec3(r.x, g.x, b.x);
  odd = vec3(r.y, g.y, b.y);
}
// The same, interpolated between the tables of the two nearest shapes of pixels.
void sap_lookup_rows(uint id, int variant, int pair, vec3 d_px, out vec3 even, out vec3 odd) {
  if (square_pixels) {
    sap_lookup_pairs(id, variant, pair, d_px, even, odd);
    return;
  }
  float at = sap_shape_node(), node = floor(at);
  vec3 next_even, next_odd;
  sap_lookup_pairs(id, variant + sap_variants * int(node), pair, d_px, even, odd);
  sap_lookup_pairs(id, variant + sap_variants * min(int(node) + 1, sap_last_shape_node()), pair,
                   d_px, next_even, next_odd);
  even = mix(even, next_even, at - node);
  odd = mix(odd, next_odd, at - node);
}
// Returns the value of a row per channel.
vec3 sap_lookup(uint id, int variant, int row, vec3 d_px) {
  vec3 even, odd;
  sap_lookup_rows(id, variant, row / 2, d_px, even, odd);
  return (row & 1) == 0 ? even : odd;
}
// Returns the weights of a pixel's own light and of the tent of level 0 per channel.
void sap_weights_of_level_0(uint id, int variant, vec3 d_px, out vec3 centre, out vec3 tent) {
  sap_lookup_rows(id, variant, 0, d_px, centre, tent);
}

#endif
