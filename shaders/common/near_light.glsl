// Light around a group of 8x8 pixels, stored once in shared memory: the scattered light that the
// nearest pixels explain, and the mean light around. The group stores its texels with
// store_near_texel, then calls finish_near_light.
#ifndef DERMIS_NEAR_LIGHT_GLSL
#define DERMIS_NEAR_LIGHT_GLSL

#include "constants.glsl"
#include "common/environment.glsl"
#include "common/patch.glsl"
#include "common/profile.glsl"

const int near_reach = 2;                // pixels to each side that explain scattered light
const int near_mean_reach = 3;     // radius in pixels of the mean
// border in pixels around the group: near_mean_reach and a ring of neighbours
const int near_ring = 4;
const int near_side = 8 + 2 * near_ring; // side of the shared square, pixels
const int near_columns = 8 + 2;          // columns of the group and a ring of neighbours
const int near_texels = near_side * near_side;
// Weight of scattered light in the mean, which keeps shadows next to light above 0.
const float near_scattered_fraction = 0.5;
const float inverse_pi = 0.31830989;

// rgb: light that can scatter; a: area of the patch over that of its pixel
shared vec4 near_light[near_texels];
// rgb: light and a part of the scattered light; a: 1 if the pixel has subsurface
shared vec4 near_mean_light[near_texels];
shared float near_depth[near_texels];     // mm; 0 if nothing is visible
shared uint near_profile[near_texels];    // 0: no subsurface
// sums of near_mean_light over rows of 2 * near_mean_reach + 1
shared vec4 near_rows[near_columns * near_side];

int near_index(ivec2 local) { return (local.y + near_ring) * near_side + local.x + near_ring; }

// Returns the smaller change of depth to either side along an axis, mm; 0 if no neighbour has the
// profile and a depth within `max_step`.
float near_rise(int index, int step, float max_step) {
  float depth = near_depth[index], minimum = 1e30;
  for (int side = -1; side <= 1; side += 2) {
    int other = index + side * step;
    if (near_profile[other] == near_profile[index] && near_depth[other] > 0.0)
      minimum = min(minimum, abs(near_depth[other] - depth));
  }
  return minimum <= max_step ? minimum : 0.0;
}
vec2 near_rise(int index) {
  vec2 max_step = max_patch_step(near_depth[index]);
  return vec2(near_rise(index, 1, max_step.x), near_rise(index, near_side, max_step.y));
}

// Returns the pixel of texel i of the shared square around the group with first pixel `first`.
ivec2 near_pixel(ivec2 first, int i) {
  return first + ivec2(i % near_side, i / near_side) - near_ring;
}

// Stores texel i; all values are 0 if the pixel has no subsurface. `light`: light that can scatter.
void store_near_texel(int i, uint id, float depth, vec3 light, vec3 scattered) {
  near_profile[i] = id;
  near_depth[i] = depth;
  near_light[i] = vec4(light, 0.0);
  near_mean_light[i] = vec4(light + near_scattered_fraction * scattered, id != 0u ? 1.0 : 0.0);
}

// Computes areas and sums over rows from the stored texels. Every invocation of the group must call
// this.
void finish_near_light() {
  barrier();
  for (int i = int(gl_LocalInvocationIndex); i < near_texels; i += 64) {
    ivec2 from_edge = min(ivec2(i % near_side, i / near_side),
                          near_side - 1 - ivec2(i % near_side, i / near_side));
    if (min(from_edge.x, from_edge.y) > 0 && near_depth[i] > 0.0) {
      vec2 slope = near_rise(i) / max(pixel_footprint(near_depth[i]), vec2(1e-20));
      near_light[i].a = min(sqrt(1.0 + dot(slope, slope)), 1.0 / min_patch_cosine);
    }
  }
  for (int i = int(gl_LocalInvocationIndex); i < near_columns * near_side; i += 64) {
    vec4 sum = vec4(0.0);
    for (int k = -near_mean_reach; k <= near_mean_reach; ++k)
      sum += near_mean_light[(i / near_columns) * near_side + i % near_columns + near_ring - 1 + k];
    near_rows[i] = sum;
  }
  barrier();
}

struct near_field {
  vec3 light;      // scattered light if only the nearest pixels contributed
  vec3 local_mean; // mean around, in the unit of light
};

// Computes the near field of a pixel of the group or of a neighbour of the group. Weights are the
// profile at each pixel's distance times the area of its patch; the pixel's own patch is treated as
// a disc.
near_field find_near_field(ivec2 local, scatter_profile profile, vec3 direct) {
  int own = near_index(local);
  float depth = near_depth[own];
  vec2 footprint = pixel_footprint(depth);
  float cross_section = footprint.x * footprint.y;
  vec3 total =
      1.0 - profile_survival(profile, sqrt(cross_section * near_light[own].a * inverse_pi));
  vec3 sum = total * near_light[own].rgb;
  for (int y = -near_reach; y <= near_reach; ++y)
    for (int x = -near_reach; x <= near_reach; ++x) {
      int other = near_index(local + ivec2(x, y));
      if ((x == 0 && y == 0) || near_profile[other] != near_profile[own] ||
          !(near_depth[other] > 0.0))
        continue;
      float r = length(vec3(vec2(x, y) * footprint, near_depth[other] - depth));
      vec3 weight =
          profile_falloff(profile, r) * (0.5 * inverse_pi * cross_section * near_light[other].a);
      sum += weight * near_light[other].rgb;
      total += weight;
    }
  bvec3 scatters =
      bvec3(uvec3(greaterThan(profile.d.rgb, vec3(0.0))) * uvec3(greaterThan(total, vec3(1e-30))));
  vec3 light = mix(near_light[own].rgb, sum / max(total, vec3(1e-30)), scatters);
  vec4 around = vec4(0.0);
  for (int k = -near_mean_reach; k <= near_mean_reach; ++k)
    around += near_rows[(local.y + near_ring + k) * near_columns + local.x + 1];
  return near_field(mix(light, near_light[own].rgb, direct), around.rgb / max(around.a, 1.0));
}

#endif
