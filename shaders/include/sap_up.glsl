// One texel on the way up: its own level, tent-filtered, and what the coarser level hands down. An invocation computes a
// block of texels: it reads them and a ring around them once, and the coarser texels on which they lie.
// Include after bindings with `light`, `surface`, `coarse_surface`, `coarse_scattered` and `level_tiles`, and after
// `block_width`, `block_height`, `coarse_width`, `coarse_height` and `odd_first`: 1 where a block's first texel is odd; across, down.
// SAP_NO_RING: the kernel has texels of the level by itself, and no `light` and `surface`.
// SAP_OWN_LAYERS, SAP_COARSE_LAYERS: layers that a texel of the level and of the coarser one has, 1 unless defined; of the
// second layer `second_light`, `second_surface`, `second_coarse_surface` and `second_coarse_scattered`.
#ifndef DERMIS_SAP_UP_GLSL
#define DERMIS_SAP_UP_GLSL

#include "sap_tiles.glsl"
#ifndef SAP_OWN_LAYERS
#define SAP_OWN_LAYERS 1
#endif
#ifndef SAP_COARSE_LAYERS
#define SAP_COARSE_LAYERS 1
#endif

struct sap_sum {
  vec3 light;
  vec3 mass; // share of the kernel that met the surface
};

#ifndef SAP_TEXELS_ACROSS // texels that are computed together: a block, unless defined
#define SAP_TEXELS_ACROSS block_width
#define SAP_TEXELS_DOWN block_height
#endif
const int texels_across = SAP_TEXELS_ACROSS, texels_down = SAP_TEXELS_DOWN;
const int coarse_texels = coarse_width * coarse_height;
#ifndef SAP_NO_RING
const int ring_width = texels_across + 2, ring_height = texels_down + 2;
const int ring_texels = ring_width * ring_height;
uvec4 ring_surface[SAP_OWN_LAYERS * ring_texels]; // one layer behind the other
vec4 ring_light[SAP_OWN_LAYERS * ring_texels];
#endif
uvec4 coarse_surface[SAP_COARSE_LAYERS * coarse_texels];
uvec4 coarse_scattered[SAP_COARSE_LAYERS * coarse_texels];

#ifndef SAP_NO_RING
// Index of texel k plus an offset in the ring's arrays.
int ring_index(int k, int i, int j) { return (k / texels_across + 1 + j) * ring_width + k % texels_across + 1 + i; }
sap_texel sap_own(int k) { return sap_unpack(ring_surface[ring_index(k, 0, 0)]); }
vec3 sap_own_light(int k) { return ring_light[ring_index(k, 0, 0)].rgb; }
float sap_own_area(int k) { return ring_light[ring_index(k, 0, 0)].a; } // its fourth root

#if SAP_OWN_LAYERS > 1
sap_texel sap_second(int k) { return sap_unpack(ring_surface[ring_texels + ring_index(k, 0, 0)]); }
vec3 sap_second_light(int k) { return ring_light[ring_texels + ring_index(k, 0, 0)].rgb; }
#endif

// Reads the texels at `first` (a texel of the level) and, if asked, the ring around it.
void read_ring(texel_block block, ivec2 first, int level, bool with_ring) {
  [[unroll]] for (int i = 0; i < ring_texels; ++i) {
    int x = i % ring_width - 1, y = i / ring_width - 1;
    bool inner = x >= 0 && y >= 0 && x < texels_across && y < texels_down;
    ivec2 at = first + ivec2(x, y), tile = (block.first + ivec2(x, y)) >> 3;
    bool needed = (inner || with_ring) && sap_inside(at, level) && tile_written(block.around, tile - block.tile + 1);
    ring_surface[i] = needed ? texelFetch(surface_image, sap_address(at, level), 0) : uvec4(0u);
    ring_light[i] = needed ? texelFetch(light_image, sap_address(at, level), 0) : vec4(0.0);
#if SAP_OWN_LAYERS > 1
    ring_surface[ring_texels + i] = needed ? texelFetch(second_surface_image, sap_address(at, level), 0) : uvec4(0u);
    ring_light[ring_texels + i] = needed ? texelFetch(second_light_image, sap_address(at, level), 0) : vec4(0.0);
#endif
  }
}
#endif

// Reads the coarser texels on which they lie. They exist where a texel of the block does.
void read_coarser(ivec2 first, int level) {
  [[unroll]] for (int i = 0; i < coarse_texels; ++i) {
    ivec2 at = ((first - 1) >> 1) + ivec2(i % coarse_width, i / coarse_width);
    bool needed = sap_inside(at, level + 1);
    coarse_surface[i] = needed ? texelFetch(coarse_surface_image, sap_address(at, level + 1), 0) : uvec4(0u);
    coarse_scattered[i] = needed ? texelFetch(coarse_scattered_image, sap_address(at, level + 1), 0) : uvec4(0u);
#if SAP_COARSE_LAYERS > 1
    coarse_surface[coarse_texels + i] = needed ? texelFetch(second_coarse_surface_image, sap_address(at, level + 1), 0) : uvec4(0u);
    coarse_scattered[coarse_texels + i] = needed ? texelFetch(second_coarse_scattered_image, sap_address(at, level + 1), 0) : uvec4(0u);
#endif
  }
}

// Whether of a texel's two layers the second is the one to take.
bool sap_takes_second(sap_texel own, sap_texel first, float first_off, sap_texel second, float second_off) {
  return second.id == own.id && (first.id != own.id || second_off < first_off);
}

#ifndef SAP_NO_RING
// 3x3 tent over the level's own light; of texel k.
sap_sum sap_tent(int k, int level, sap_texel own) {
  float spacing = float(1 << level);
  float per_sigma = 1.0 / (sap_sigma * spacing), per_sigma_mm = per_sigma / sap_footprint(own.depth);
  // Tilt in units of the tent's width: across, down, and along both diagonals; it is the same to both sides.
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
      sap_texel tap = sap_unpack(ring_surface[ring_index(k, i, j)]);
      vec4 light = ring_light[ring_index(k, i, j)];
      float off = sap_off_plane(own, tap, offset);
#if SAP_OWN_LAYERS > 1
      sap_texel second = sap_unpack(ring_surface[ring_texels + ring_index(k, i, j)]);
      float second_off = sap_off_plane(own, second, offset);
      if (sap_takes_second(own, tap, off, second, second_off)) {
        tap = second;
        light = ring_light[ring_texels + ring_index(k, i, j)];
        off = second_off;
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

// Bilinear over the four nearest texels of the coarser level, along the surface; of texel k. `confidence` gets the
// share that survives with stricter weights of the further tangent plane: both must see the other on theirs.
sap_sum sap_from_coarser(int k, int level, sap_texel own, vec3 fallback, out float confidence) {
  float spacing = float(1 << level);
  float per_sigma_mm = 1.0 / (sap_sigma * spacing * sap_footprint(own.depth));
  vec3 sum = vec3(0.0), mass = vec3(0.0);
  confidence = 0.0;
  ivec2 at = ivec2(k % texels_across, k / texels_across) + odd_first; // as from an even texel
  int x = at.x, y = at.y;
  ivec2 first = texels_across == 1 ? ivec2(0) : ((at - 1) >> 1) - ((odd_first - 1) >> 1); // of the coarser ones
  [[unroll]] for (int j = 0; j < 2; ++j)
    [[unroll]] for (int i = 0; i < 2; ++i) {
      int qx = ((x - 1) >> 1) + i, qy = ((y - 1) >> 1) + j;
      vec2 steps = vec2(float(2 * qx - x) + 0.5, float(2 * qy - y) + 0.5), offset = steps * spacing;
      float bilinear = (abs(steps.x) < 1.0 ? 0.75 : 0.25) * (abs(steps.y) < 1.0 ? 0.75 : 0.25);
      int index = (first.y + j) * coarse_width + first.x + i;
      sap_texel tap = sap_unpack(coarse_surface[index]);
      float off = sap_off_planes(own, tap, offset);
#if SAP_COARSE_LAYERS > 1
      sap_texel second = sap_unpack(coarse_surface[coarse_texels + index]);
      float second_off = sap_off_planes(own, second, offset);
      if (sap_takes_second(own, tap, off, second, second_off)) {
        index += coarse_texels;
        tap = second;
        off = second_off;
      }
#endif
      off *= per_sigma_mm;
      float kept = tap.id == own.id ? exp2(sap_factor(sap_depth_width) * off * off) : 0.0;
      sap_scattered theirs = settings.storage == STORAGE_FULL ? sap_unpack_scattered_full(coarse_scattered[index])
                                                              : sap_unpack_scattered(coarse_scattered[index]);
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

// d per channel in pixels along the surface.
vec3 sap_d_px(sap_texel own) {
  return profiles[min(own.id, 255u)].d_mm.rgb * (own.reach / sap_footprint(own.depth));
}

// Mean of three lights weighted by mass, a convex one: it stays within them.
sap_sum sap_blend(vec3 weight_a, vec3 a, vec3 weight_b, vec3 b, sap_sum rest) {
  vec3 total = weight_a + weight_b + rest.mass;
  vec3 scale = 1.0 / max(total, vec3(sap_negligible));
  return sap_sum(rest.light + weight_a * scale * (a - rest.light) + weight_b * scale * (b - rest.light), total);
}

#endif
