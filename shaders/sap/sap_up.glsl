// One texel on the way up: its own level, tent-filtered, and the values of the coarser level.
// Functions work on the current texel. `near_surface` and `near_light` hold its 3x3 neighbourhood
// in its own level; `corner_surface` and `corner_scattered` hold the 2x2 nearest texels of the
// coarser level. An invocation computes a block of texels. It reads the block, a ring around the
// block and the coarser texels under it once, and copies each texel's neighbourhood from there.
// Include after bindings with `light`, `surface`, `coarse_surface`, `coarse_scattered` and
// `level_tiles`, and after `block_width`, `block_height`, `coarse_width`, `coarse_height` and
// `odd_first` (across, down: 1 if a block's first texel is odd).
// - SAP_NO_RING: the kernel reads texels of the level by itself and has no `light` and `surface`.
// - SAP_OWN_LAYERS, SAP_COARSE_LAYERS: maximum layers of a texel of the level and of the coarser
//   level; 1 unless defined. The second layer needs `second_light`, `second_surface`,
//   `second_coarse_surface` and `second_coarse_scattered`. With two own layers a block is read with
//   one layer, and texels that involve a second layer are read one by one.
// - SAP_SECOND_MAY_LACK: the second layer of the coarser level is optional.
#ifndef DERMIS_SAP_UP_GLSL
#define DERMIS_SAP_UP_GLSL

#include "sap/sap_tiles.glsl"
#ifndef SAP_OWN_LAYERS
#define SAP_OWN_LAYERS 1
#endif
#ifndef SAP_COARSE_LAYERS
#define SAP_COARSE_LAYERS 1
#endif

struct sap_sum {
  vec3 light;
  vec3 mass; // fraction of the kernel that hit the surface
};

const int corner_texels = 4, near_texels = 9, near_centre = 4;
uvec4 corner_surface[SAP_COARSE_LAYERS * corner_texels]; // the second layer follows the first
uvec4 corner_scattered[SAP_COARSE_LAYERS * corner_texels];
#ifndef SAP_NO_RING
uvec4 near_surface[SAP_OWN_LAYERS * near_texels];
vec4 near_light[SAP_OWN_LAYERS * near_texels];
#endif

// Coarser texels of a block. Their second layers follow, unless the level itself has two layers.
const int block_coarse_layers = SAP_OWN_LAYERS > 1 ? 1 : SAP_COARSE_LAYERS;
const int coarse_texels = coarse_width * coarse_height;
uvec4 coarse_surface[block_coarse_layers * coarse_texels];
uvec4 coarse_scattered[block_coarse_layers * coarse_texels];

#ifndef SAP_NO_RING
const int ring_width = block_width + 2, ring_height = block_height + 2;
uvec4 ring_surface[ring_width * ring_height];
vec4 ring_light[ring_width * ring_height];

// Returns the index of texel k plus an offset in the ring's arrays.
int ring_index(int k, int i, int j) { return (k / block_width + 1 + j) * ring_width + k % block_width + 1 + i; }

// Reads the texels from `first` (a texel of the level) on and, if requested, the ring around them.
void read_ring(texel_block block, ivec2 first, int level, bool with_ring) {
  [[unroll]] for (int i = 0; i < ring_width * ring_height; ++i) {
    int x = i % ring_width - 1, y = i / ring_width - 1;
    bool inner = x >= 0 && y >= 0 && x < block_width && y < block_height;
    ivec2 at = first + ivec2(x, y), tile = (block.first + ivec2(x, y)) >> 3;
    bool needed = (inner || with_ring) && sap_inside(at, level) && tile_written(block.around, tile - block.tile + 1);
    ring_surface[i] = needed ? texelFetch(surface_image, sap_address(at, level), 0) : uvec4(0u);
    ring_light[i] = needed ? texelFetch(light_image, sap_address(at, level), 0) : vec4(0.0);
  }
}
// Copies the neighbourhood of texel k. Returns the union of its surface bits.
uint take_near(int k) {
  uint bits = 0u;
  [[unroll]] for (int n = 0; n < near_texels; ++n) {
    int i = ring_index(k, n % 3 - 1, n / 3 - 1);
    near_surface[n] = ring_surface[i];
    near_light[n] = ring_light[i];
    bits |= ring_surface[i].w;
  }
  return bits;
}
#endif

// Reads the coarser texels under a block. They exist if a texel of the block exists.
void read_coarser(ivec2 first, int level) {
  [[unroll]] for (int i = 0; i < coarse_texels; ++i) {
    ivec2 at = ((first - 1) >> 1) + ivec2(i % coarse_width, i / coarse_width);
    bool needed = sap_inside(at, level + 1);
    coarse_surface[i] = needed ? texelFetch(coarse_surface_image, sap_address(at, level + 1), 0) : uvec4(0u);
    coarse_scattered[i] = needed ? texelFetch(coarse_scattered_image, sap_address(at, level + 1), 0) : uvec4(0u);
#if SAP_COARSE_LAYERS > 1 && SAP_OWN_LAYERS == 1
    needed = needed && sap_has_second(coarse_surface[i]);
#ifdef SAP_SECOND_MAY_LACK
    needed = needed && has_second_coarse_surface() && has_second_coarse_scattered();
#endif
    coarse_surface[coarse_texels + i] = needed ? texelFetch(second_coarse_surface_image, sap_address(at, level + 1), 0) : uvec4(0u);
    coarse_scattered[coarse_texels + i] = needed ? texelFetch(second_coarse_scattered_image, sap_address(at, level + 1), 0) : uvec4(0u);
#endif
  }
}
// Returns the parity of the position of texel k.
ivec2 odd_of(int k) { return (ivec2(k % block_width, k / block_width) + odd_first) & 1; }
// Copies the coarser texels under texel k. Returns the union of their surface bits.
uint take_corners(int k) {
  ivec2 at = ivec2(k % block_width, k / block_width) + odd_first; // relative to an even texel
  ivec2 first = ((at - 1) >> 1) - ((odd_first - 1) >> 1);
  uint bits = 0u;
  [[unroll]] for (int n = 0; n < block_coarse_layers * corner_texels; ++n) {
    int i = n / corner_texels * coarse_texels + (first.y + n % corner_texels / 2) * coarse_width + first.x + n % 2;
    corner_surface[n] = coarse_surface[i];
    corner_scattered[n] = coarse_scattered[i];
    bits |= coarse_surface[i].w;
  }
  return bits;
}

#if SAP_OWN_LAYERS > 1
// Reads both layers of a texel of the block and, if requested, of its neighbours.
void read_near(texel_block block, ivec2 offset, ivec2 place, int level, bool with_ring) {
  [[unroll]] for (int n = 0; n < near_texels; ++n) {
    ivec2 step = ivec2(n % 3 - 1, n / 3 - 1), at = place + step, tile = (block.first + offset + step) >> 3;
    bool needed = (n == near_centre || with_ring) && sap_inside(at, level) && tile_written(block.around, tile - block.tile + 1);
    near_surface[n] = needed ? texelFetch(surface_image, sap_address(at, level), 0) : uvec4(0u);
    near_light[n] = needed ? texelFetch(light_image, sap_address(at, level), 0) : vec4(0.0);
    needed = needed && sap_has_second(near_surface[n]);
    near_surface[near_texels + n] = needed ? texelFetch(second_surface_image, sap_address(at, level), 0) : uvec4(0u);
    near_light[near_texels + n] = needed ? texelFetch(second_light_image, sap_address(at, level), 0) : vec4(0.0);
  }
}
// Reads both layers of the coarser texels under the texel.
void read_corners(ivec2 place, int level, bool there) {
  [[unroll]] for (int n = 0; n < corner_texels; ++n) {
    ivec2 at = ((place - 1) >> 1) + ivec2(n % 2, n / 2);
    bool needed = there && sap_inside(at, level + 1);
    corner_surface[n] = needed ? texelFetch(coarse_surface_image, sap_address(at, level + 1), 0) : uvec4(0u);
    corner_scattered[n] = needed ? texelFetch(coarse_scattered_image, sap_address(at, level + 1), 0) : uvec4(0u);
    needed = needed && sap_has_second(corner_surface[n]) && has_second_coarse_surface() && has_second_coarse_scattered();
    int second = corner_texels + n;
    corner_surface[second] = needed ? texelFetch(second_coarse_surface_image, sap_address(at, level + 1), 0) : uvec4(0u);
    corner_scattered[second] = needed ? texelFetch(second_coarse_scattered_image, sap_address(at, level + 1), 0) : uvec4(0u);
  }
}
#endif

// Returns whether to use the second of a texel's two layers.
bool sap_takes_second(sap_texel own, sap_texel first, float first_off, sap_texel second, float second_off) {
  return second.id == own.id && (first.id != own.id || second_off < first_off);
}

#ifndef SAP_NO_RING
// Returns a 3x3 tent over the level's own light, over its first `layers` layers.
sap_sum sap_tent(int level, sap_texel own, int layers) {
  float spacing = float(1 << level);
  float per_sigma = 1.0 / (sap_sigma * spacing), per_sigma_mm = per_sigma / sap_footprint(own.depth);
  // Tilt in units of the tent's width: across, down, and along both diagonals. The tilt is
  // symmetric to both sides.
  vec2 tilt = own.slope * (spacing * per_sigma);
  vec4 tilts = vec4(tilt, tilt.x + tilt.y, tilt.x - tilt.y);
  vec4 narrowing = exp2(sap_factor(sap_tilt_width_tent) * tilts * tilts);
  vec3 sum = vec3(0.0);
  float total = 0.0, mass = 0.0;
  [[unroll]] for (int j = -1; j <= 1; ++j)
    [[unroll]] for (int i = -1; i <= 1; ++i) {
      vec2 offset = vec2(i, j) * spacing;
      float weight = float((2 - abs(i)) * (2 - abs(j)));
      if (i != 0 || j != 0)
        weight *= j == 0 ? narrowing.x : i == 0 ? narrowing.y : i == j ? narrowing.z : narrowing.w;
      int n = 3 * (j + 1) + i + 1;
      sap_texel tap = sap_unpack(near_surface[n]);
      vec4 light = near_light[n];
      float off = sap_off_plane(own, tap, offset);
#if SAP_OWN_LAYERS > 1
      if (layers > 1) {
        sap_texel second = sap_unpack(near_surface[near_texels + n]);
        float second_off = sap_off_plane(own, second, offset);
        if (sap_takes_second(own, tap, off, second, second_off)) {
          tap = second;
          light = near_light[near_texels + n];
          off = second_off;
        }
      }
#endif
      off *= per_sigma_mm;
      weight *= exp2(sap_factor(sap_depth_width) * off * off) * tap.mass;
      weight = tap.id == own.id ? weight : 0.0;
      mass += weight;
      total += weight * light.a;
      sum += weight * light.a * light.rgb;
    }
  float all_weight = 4.0 + 4.0 * (narrowing.x + narrowing.y) + 2.0 * (narrowing.z + narrowing.w);
  return sap_sum(sum / total, vec3(mass / all_weight));
}
#endif

// Interpolates bilinearly, along the surface, over the four nearest texels of the coarser level and
// their first `layers` layers, from a texel of parity `odd`. `confidence` receives the fraction
// that remains with stricter weights, which use the farther tangent plane: each texel must lie on
// the plane of the other.
sap_sum sap_from_coarser(ivec2 odd, int level, sap_texel own, vec3 fallback, int layers, out float confidence) {
  float spacing = float(1 << level);
  float per_sigma_mm = 1.0 / (sap_sigma * spacing * sap_footprint(own.depth));
  vec3 sum = vec3(0.0), mass = vec3(0.0);
  confidence = 0.0;
  [[unroll]] for (int j = 0; j < 2; ++j)
    [[unroll]] for (int i = 0; i < 2; ++i) {
      vec2 steps = vec2(2 * ((odd - 1) >> 1) + 2 * ivec2(i, j) - odd) + 0.5, offset = steps * spacing;
      float bilinear = (abs(steps.x) < 1.0 ? 0.75 : 0.25) * (abs(steps.y) < 1.0 ? 0.75 : 0.25);
      int n = 2 * j + i;
      sap_texel tap = sap_unpack(corner_surface[n]);
      uvec4 handed_down = corner_scattered[n];
      float off = sap_off_planes(own, tap, offset);
#if SAP_COARSE_LAYERS > 1
      if (layers > 1) {
        sap_texel second = sap_unpack(corner_surface[corner_texels + n]);
        float second_off = sap_off_planes(own, second, offset);
        if (sap_takes_second(own, tap, off, second, second_off)) {
          tap = second;
          handed_down = corner_scattered[corner_texels + n];
          off = second_off;
        }
      }
#endif
      off *= per_sigma_mm;
      float kept = tap.id == own.id ? exp2(sap_factor(sap_depth_width) * off * off) : 0.0;
      sap_scattered theirs = settings.storage == STORAGE_FULL ? sap_unpack_scattered_full(handed_down)
                                                              : sap_unpack_scattered(handed_down);
      vec3 tap_mass = bilinear * kept * theirs.mass;
      mass += tap_mass;
      sum += tap_mass * theirs.light;
      float depth_step = tap.depth - own.depth;
      float further = max(abs(depth_step - sap_rise(own.depth, own.slope, offset)),
                          abs(depth_step - sap_rise(tap.depth, tap.slope, offset))) * per_sigma_mm;
      float strictly = exp2(sap_factor(sap_confidence_width) * further * further);
      confidence += tap.id == own.id ? bilinear * strictly * theirs.confidence : 0.0;
    }
  vec3 found = vec3(greaterThan(mass, vec3(sap_negligible)));
  return sap_sum(mix(fallback, sum / max(mass, vec3(sap_negligible)), found), mass);
}

// Returns d per channel in pixels along the surface.
vec3 sap_d_px(sap_texel own) {
  return profiles[min(own.id, 255u)].d_mm.rgb * (own.reach / sap_footprint(own.depth));
}

// Returns the mean of three lights weighted by mass, as a convex combination that returns equal
// lights unchanged. Unequal lights round, so the result is clamped: almost no light next to glare
// could become negative.
sap_sum sap_blend(vec3 weight_a, vec3 a, vec3 weight_b, vec3 b, sap_sum rest) {
  vec3 total = weight_a + weight_b + rest.mass;
  vec3 scale = 1.0 / max(total, vec3(sap_negligible));
  vec3 mean = rest.light + weight_a * scale * (a - rest.light) + weight_b * scale * (b - rest.light);
  return sap_sum(max(mean, vec3(0.0)), total);
}

#endif
