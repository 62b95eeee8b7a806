// Light around a group of 8x8 pixels, stored once in shared memory: the scattered light that the
// nearest pixels explain, and the mean light around. The group stores its texels with
// store_near_texel, then calls finish_near_light.
#ifndef DERMIS_NEAR_LIGHT_GLSL
#define DERMIS_NEAR_LIGHT_GLSL

#extension GL_EXT_control_flow_attributes : require

#include "constants.glsl"
#include "common/environment.glsl"
#include "common/patch.glsl"
#include "common/profile.glsl"

const int near_reach = 2;      // pixels to each side that explain scattered light
const int near_mean_reach = 3; // radius in pixels of the mean
// Border in pixels around the group: near_reach and a ring of neighbours. The four corners are left
// out, so that each invocation stores three texels.
const int near_border = 3;
const int near_side = 8 + 2 * near_border; // side of the shared square, pixels
const int near_columns = 8 + 2;            // columns of the group and a ring of neighbours
const int near_texels_each = 3;            // texels that an invocation stores
// Weight of scattered light in the average, which keeps shadows next to light above 0.
const float near_scattered_fraction = 0.5;
const float inverse_pi = 0.31830989;

// x: depth, mm; y: profile, 0 if the pixel has no subsurface or no depth. One more pixel around the
// square has no surface. With this stride, 16 invocations in two rows read different banks.
const int near_surface_stride = 24;
shared vec2 near_surface[near_surface_stride * (near_side + 2)];
// a: area of the patch over that of its pixel, 0 if near_surface has no profile; rgb: light that
// can scatter, times a
shared vec4 near_light[near_side * near_side];
// rgb: light and a part of the scattered light; a: 1 if the pixel has subsurface. Free for other
// values after finish_near_light.
shared vec4 near_mean_light[2 * near_columns * near_columns];
// sums of near_mean_light over rows of 2 * near_mean_reach + 1
shared vec4 near_rows[near_columns * near_side];

int near_index(ivec2 local) { return (local.y + near_border) * near_side + local.x + near_border; }
int near_surface_index(ivec2 local) {
  return (local.y + near_border + 1) * near_surface_stride + local.x + near_border + 1;
}
vec2 near_surface_at(ivec2 local) { return near_surface[near_surface_index(local)]; }

// Rotates a position in the group by quarter turns about the group's centre.
ivec2 turn_in_group(ivec2 local, int turns) {
  ivec2 turned = (turns & 1) != 0 ? ivec2(7 - local.y, local.x) : local;
  return (turns & 2) != 0 ? 7 - turned : turned;
}

// Returns the k-th texel that this invocation stores, as a position in the group: its own pixel,
// then texels of the border. A side of the border has 3 rows of 11 texels, without the first, which
// is a corner.
ivec2 near_texel(int k) {
  if (k == 0)
    return ivec2(gl_LocalInvocationID.xy);
  int i = int(gl_LocalInvocationIndex), place = (i & 31) + 1;
  int row = place < 11 ? 0 : place < 22 ? 1 : 2;
  return turn_in_group(ivec2(place - 11 * row, row) - near_border, 2 * (k - 1) + (i >> 5));
}

// Stores the pixels around the square and the corners, one per invocation: nothing is there.
void clear_near_border() {
  int i = int(gl_LocalInvocationIndex), place = i & 15;
  bool corner = place == 15;
  ivec2 local = turn_in_group(
      corner ? ivec2(-near_border) : ivec2(place - near_border - 1, -near_border - 1), i >> 4);
  near_surface[near_surface_index(local)] = vec2(0.0);
  if (corner)
    near_mean_light[near_index(local)] = vec4(0.0);
}

// Stores a texel, except its light; all values are 0 if the pixel has no subsurface. `light`: light
// that can scatter.
void store_near_texel(ivec2 local, uint id, float depth, vec3 light, vec3 scattered) {
  near_surface[near_surface_index(local)] = vec2(depth, depth > 0.0 ? float(id) : 0.0);
  near_mean_light[near_index(local)] =
      vec4(light + near_scattered_fraction * scattered, id != 0u ? 1.0 : 0.0);
}

// Returns the smaller change of depth to either side along an axis, mm; 1e30 if no neighbour has
// the profile.
float near_rise(int index, vec2 surface, int step) {
  vec2 before = near_surface[index - step], after = near_surface[index + step];
  return min(before.y == surface.y ? abs(before.x - surface.x) : 1e30,
             after.y == surface.y ? abs(after.x - surface.x) : 1e30);
}
// Returns the smaller changes of depth along the row and the column, in footprints per pixel; 0 if
// no neighbour is on the surface. `inverse_footprint`: 1 over the pixel's size across the view.
vec2 near_slope(int index, vec2 surface, vec2 inverse_footprint) {
  vec2 slope =
      vec2(near_rise(index, surface, 1), near_rise(index, surface, near_surface_stride)) *
      inverse_footprint;
  return mix(slope, vec2(0.0), greaterThan(slope, vec2(max_patch_slope)));
}

// Returns the first row or column of the mean around a position. Around pixels of the ring, the
// mean's square is moved by one pixel into the shared square.
int first_of_mean(int local) { return clamp(local, 0, 7) - near_mean_reach; }

void sum_rows() {
  int i = int(gl_LocalInvocationIndex);
  // Two steps for 8 columns, then one for the first and the last.
  [[dont_unroll]] for (int step = 0; step < 3; ++step) {
    ivec2 at = step < 2 ? ivec2(i & 7, (i >> 3) + 8 * step) : ivec2((i & 1) * 9 - 1, i >> 1);
    at.y -= near_border;
    if (at.y >= 8 + near_border)
      break;
    int first = near_index(ivec2(first_of_mean(at.x), at.y));
    vec4 sum = near_mean_light[first];
    [[unroll]] for (int k = 1; k <= 2 * near_mean_reach; ++k)
      sum += near_mean_light[first + k];
    near_rows[(at.y + near_border) * near_columns + at.x + 1] = sum;
  }
}

// Stores areas and the light that can scatter, of the texels in the order of near_texel. Computes
// sums over rows. Returns the change of depth over the invocation's own pixel, mm. Every invocation
// of the group must call this.
float finish_near_light(vec3 light[near_texels_each]) {
  clear_near_border();
  barrier();
  float own_rise = 0.0;
  vec2 inverse_scale = 1.0 / max(abs(frame.ray_scale), vec2(1e-20));
  [[unroll]] for (int k = 0; k < near_texels_each; ++k) {
    ivec2 local = near_texel(k);
    int i = near_surface_index(local);
    vec2 surface = near_surface[i];
    vec2 inverse_footprint =
        inverse_scale * (is_perspective() ? 1.0 / max(surface.x, 1e-20) : 1.0);
    vec2 slope = near_slope(i, surface, inverse_footprint);
    float area = min(sqrt(1.0 + dot(slope, slope)), 1.0 / min_patch_cosine);
    area = surface.y > 0.0 ? area : 0.0;
    near_light[near_index(local)] = vec4(light[k] * area, area);
    if (k == 0)
      own_rise = length(slope / inverse_footprint);
  }
  sum_rows();
  barrier();
  return own_rise;
}

// Sums over neighbours, with profile_falloff times area as weights.
struct near_sums {
  vec3 light, weight;
};
void add_neighbour(inout near_sums sums, vec3 falloff, vec4 light) {
  sums.light += falloff * light.rgb;
  sums.weight += falloff * light.a;
}

const int near_neighbours = (2 * near_reach + 1) * (2 * near_reach + 1) - 1;
// Returns the offset of the i-th neighbour.
ivec2 near_offset(int i) {
  const int side = 2 * near_reach + 1;
  int k = i < near_neighbours / 2 ? i : i + 1;
  return ivec2(k % side, k / side) - near_reach;
}

// Sums over all neighbours for Burley's profile.
near_sums sum_burley(ivec2 local, scatter_profile profile) {
  vec2 surface = near_surface_at(local), footprint = pixel_footprint(surface.x);
  vec2 squared_footprint = footprint * footprint;
  vec3 inverse_d = 1.0 / max(profile.d.rgb, vec3(1e-30));
  vec3 rate = inverse_d * (-1.4426950408889634 / 3.0); // of exp2, for the slower exponential
  near_sums sums = near_sums(vec3(0.0), vec3(0.0));
  [[unroll]] for (int i = 0; i < near_neighbours; ++i) {
    ivec2 offset = near_offset(i);
    vec2 other = near_surface_at(local + offset);
    float rise = other.x - surface.x;
    float squared_r = rise * rise + dot(vec2(offset * offset), squared_footprint);
    float inverse_r = inversesqrt(squared_r);
    vec3 e = exp2(squared_r * inverse_r * rate);
    inverse_r = other.y == surface.y ? inverse_r : 0.0;
    // Burley's falloff is 0.25 / d (e^3 + e) / r.
    add_neighbour(sums, (e * e + 1.0) * (e * inverse_r), near_light[near_index(local + offset)]);
  }
  return near_sums(sums.light * (0.25 * inverse_d), sums.weight * (0.25 * inverse_d));
}

// Sums over all neighbours for a profile of the radial table.
near_sums sum_table(ivec2 local, scatter_profile profile) {
  vec2 surface = near_surface_at(local), footprint = pixel_footprint(surface.x);
  near_sums sums = near_sums(vec3(0.0), vec3(0.0));
  [[dont_unroll]] for (int i = 0; i < near_neighbours; ++i) {
    ivec2 offset = near_offset(i);
    vec2 other = near_surface_at(local + offset);
    float r = length(vec3(vec2(offset) * footprint, other.x - surface.x));
    if (other.y == surface.y)
      add_neighbour(sums, profile_falloff(profile, r), near_light[near_index(local + offset)]);
  }
  return sums;
}

struct near_field {
  vec3 light;      // scattered light if only the nearest pixels contributed
  vec3 local_mean; // mean around, in the unit of light
};

// Computes the near field of a pixel of the group or of a neighbour of the group. Weights are the
// profile at each pixel's distance times the area of its patch; the pixel's own patch is treated as
// a disc.
near_field find_near_field(ivec2 local, scatter_profile profile, vec3 direct) {
  near_sums sums;
  if (profile.row == no_radial_row)
    sums = sum_burley(local, profile);
  else
    sums = sum_table(local, profile);
  vec4 own_light = near_light[near_index(local)];
  vec3 unscattered = own_light.rgb / own_light.a;
  vec2 footprint = pixel_footprint(near_surface_at(local).x);
  float cross_section = footprint.x * footprint.y, factor = 0.5 * inverse_pi * cross_section;
  vec3 own_weight = 1.0 - profile_survival(profile, sqrt(cross_section * own_light.a * inverse_pi));
  vec3 total = sums.weight * factor + own_weight;
  vec3 light = (sums.light * factor + own_weight * unscattered) / max(total, vec3(1e-30));
  bvec3 scatters =
      bvec3(uvec3(greaterThan(profile.d.rgb, vec3(0.0))) * uvec3(greaterThan(total, vec3(1e-30))));
  light = mix(unscattered, light, scatters);
  vec4 around = vec4(0.0);
  int first = (first_of_mean(local.y) + near_border) * near_columns + local.x + 1;
  [[unroll]] for (int k = 0; k <= 2 * near_mean_reach; ++k)
    around += near_rows[first + k * near_columns];
  return near_field(mix(light, unscattered, direct), around.rgb / max(around.a, 1.0));
}

#endif
