// One texel on the way up: its own level, tent-filtered, and the values of the coarser level.
#ifndef DERMIS_SAP_UP_GLSL
#define DERMIS_SAP_UP_GLSL

#include "constants.glsl"
#include "sap/sap_storage.glsl"
#include "sap/sap_tent.glsl"

// The texel that is computed.
struct sap_place {
  ivec2 at;   // texel of its level
  ivec2 odd;  // parity of its position
  int ring;   // its index among the texels of its level that were read
  int corner; // index of its first corner among the texels of the coarser level that were read
  // 0 in kernels that compute one level:
  int window; // number of its level among those of the dispatch
  int handed; // index of its first corner among the values of the coarser level
  int index;  // its own index among the values of its level
};

// The neighbourhood. sap_window.glsl defines these eight functions; sap_neighbours.glsl defines the
// last two, and its kernel the others that it uses. `layer`: 0 or 1.
// Return the surface and light of the neighbour at `step` texels: 0 without a surface.
uvec4 near_surface(sap_place place, ivec2 step, int layer);
vec4 near_light(sap_place place, int level, ivec2 step, int layer);
// Return the surface and the values of corner n of the 2x2 nearest texels of the coarser level.
uvec4 corner_surface(sap_place place, int n, int layer);
uvec4 corner_scattered(sap_place place, int level, int n, int layer);
// Return whether the second layer of a texel of the level and of the coarser level can be read.
bool has_second_near(uvec4 bits);
bool has_second_corner(uvec4 bits);
// Returns the texels to each side that the tent reads.
int tent_reach();
// Returns whether to branch around second layers that do not exist. If not, they must read as 0.
bool branches_on_layers();

struct sap_sum {
  vec3 light;
  vec3 mass; // fraction of the kernel that hit the surface, as sap_texel
};

// Returns whether to use the second of a texel's two layers.
bool sap_takes_second(sap_texel own, sap_texel first, float first_off, sap_texel second,
                      float second_off) {
  return second.id == own.id && (first.id != own.id || second_off < first_off);
}

// Returns a tent over the level's own light, over its first `layers` layers: 3x3 texels, or more if
// pixels are not square.
sap_sum sap_tent(sap_place place, int level, sap_texel own, int layers) {
  float spacing = sap_spacing(level);
  vec2 spacings = sap_spacings(level);
  float per_sigma = 1.0 / (sap_sigma * spacing);
  float off_unit = sap_rate(sap_depth_width) * per_sigma / sap_footprint(own.depth);
  // Tilt in units of the tent's width: across, down, and along both diagonals. The tilt is
  // symmetric to both sides.
  vec2 tilt = own.slope * (spacing * per_sigma);
  vec4 tilts = vec4(tilt, tilt.x + tilt.y, tilt.x - tilt.y);
  vec4 narrowing = exp2(sap_factor(sap_tilt_width_tent) * tilts * tilts);
  vec3 sum = vec3(0.0);
  float total = 0.0, mass = 0.0;
  float all_weight = 4.0 + 4.0 * (narrowing.x + narrowing.y) + 2.0 * (narrowing.z + narrowing.w);
  sap_tent_weights weights = sap_tent_of_level(level);
  if (!square_pixels)
    all_weight = 0.0;
  const int reach = tent_reach();
  [[unroll]] for (int j = -reach; j <= reach; ++j)
    [[unroll]] for (int i = -reach; i <= reach; ++i) {
      ivec2 step = ivec2(i, j);
      vec2 offset = vec2(step) * spacings;
      float weight = float((2 - abs(i)) * (2 - abs(j)));
      if (i != 0 || j != 0)
        weight *= j == 0 ? narrowing.x : i == 0 ? narrowing.y : i == j ? narrowing.z : narrowing.w;
      if (!square_pixels) {
        float along = dot(own.slope, offset) * per_sigma;
        weight = weights.across[abs(i)] * weights.down[abs(j)] *
                 exp2(sap_factor(sap_tilt_width_tent) * along * along);
        if (weight == 0.0)
          continue;
        all_weight += weight;
      }
      uvec4 bits = uvec4(0u);
      vec4 light = vec4(0.0);
      float off = 0.0;
      [[unroll]] for (int layer = 0; layer < layers; ++layer) {
        if (layer > 0 && branches_on_layers() && !has_second_near(bits))
          continue;
        uvec4 layer_bits = near_surface(place, step, layer);
        sap_texel texel = sap_unpack(layer_bits);
        float layer_off = sap_off_plane(own, texel, offset);
        if (layer == 0 || sap_takes_second(own, sap_unpack(bits), off, texel, layer_off)) {
          bits = layer_bits;
          light = near_light(place, level, step, layer);
          off = layer_off;
        }
      }
      sap_texel tap = sap_unpack(bits); // only the bits stay in registers across the branch
      off *= off_unit;
      weight *= exp2(-off * off) * (level == 0 ? 1.0 : tap.mass);
      weight = tap.id == own.id ? weight : 0.0;
      mass += weight;
      total += weight * light.a;
      sum += weight * light.a * light.rgb;
    }
  return sap_sum(sum / total, vec3(mass / all_weight));
}

// Interpolates bilinearly, along the surface, over the four nearest texels of the coarser level and
// their first `layers` layers, at the texel at `place`. `confidence` receives the fraction of the
// surface around that the coarser levels represent. A texel counts fully if each of both lies on
// the plane of the other. Else it is as good as lost, unless the surface of the texel is so far off
// that it does not matter here and no other one was merged into it. Where no surface is, nothing is
// lost.
sap_sum sap_from_coarser(sap_place place, int level, sap_texel own, vec3 fallback, int layers,
                         out float confidence) {
  float width =
      sap_spacing(level) < sap_first_wide_spacing ? sap_depth_width : sap_depth_width_up;
  float off_unit = sap_rate(width) / (sap_sigma * sap_spacing(level) * sap_footprint(own.depth));
  vec2 odd = vec2(place.odd), nearer = 0.25 + 0.5 * odd;
  // An axis that is not halved has one texel, at the same position.
  bvec2 halves = greaterThan(step_from_level(level), ivec2(1));
  vec2 distances = mix(vec2(0.0), sap_spacings(level), halves);
  nearer = mix(vec2(1.0), nearer, halves);
  vec2 farther = 1.0 - nearer;
  vec3 sum = vec3(0.0), mass = vec3(0.0);
  float existing = 0.0, per_relevant = sap_per_relevant(own, sap_spacing(level)) / sap_rate(width);
  confidence = 0.0;
  [[unroll]] for (int j = 0; j < 2; ++j)
    [[unroll]] for (int i = 0; i < 2; ++i) {
      // An odd texel is nearer to its first corner, an even one to its second: by 0.5 to 1.5.
      vec2 steps = odd - 1.5 + 2.0 * vec2(i, j), offset = steps * distances;
      float bilinear = (i == 0 ? nearer.x : farther.x) * (j == 0 ? nearer.y : farther.y);
      if (!square_pixels && bilinear == 0.0)
        continue; // the texel may not exist
      int n = 2 * j + i;
      uvec4 bits = uvec4(0u);
      float off = 0.0;
      uvec4 handed_down = uvec4(0u);
      [[unroll]] for (int layer = 0; layer < layers; ++layer) {
        if (layer > 0 && branches_on_layers() && !has_second_corner(bits))
          continue;
        uvec4 layer_bits = corner_surface(place, n, layer);
        sap_texel texel = sap_unpack(layer_bits);
        float layer_off = sap_off_planes(own, texel, offset);
        if (layer == 0 || sap_takes_second(own, sap_unpack(bits), off, texel, layer_off)) {
          bits = layer_bits;
          off = layer_off;
          handed_down = corner_scattered(place, level, n, layer);
        }
      }
      sap_texel tap = sap_unpack(bits); // only the bits stay in registers across the branch
      off *= off_unit;
      bool same = tap.id == own.id;
      float kept = exp2(-off * off);
      kept = same ? kept : 0.0;
      sap_scattered theirs = stores_full() ? sap_unpack_scattered_full(handed_down)
                                           : sap_unpack_scattered(handed_down);
      vec3 tap_mass = bilinear * kept * theirs.mass;
      mass += tap_mass;
      sum += tap_mass * theirs.light;
      float depth_step = tap.depth - own.depth;
      float further = max(abs(depth_step - sap_rise(own.depth, own.slope, offset)),
                          abs(depth_step - sap_rise(tap.depth, tap.slope, offset))) * off_unit;
      float strictly = exp2(-further * further * (width * width) /
                            (sap_confidence_width * sap_confidence_width));
      float lost = (1.0 - strictly) * max(sap_relevance(off * per_relevant), sap_not_held(tap));
      float known = bilinear * (1.0 - lost) * theirs.confidence, lost_here = sap_lost(bits);
      confidence += same ? known : 0.0;
      existing += bilinear * (same ? 1.0 : lost_here);
    }
  confidence = existing > 1e-6 ? confidence / existing : 1.0;
  vec3 found = vec3(greaterThan(mass, vec3(sap_negligible)));
  return sap_sum(mix(fallback, sum / max(mass, vec3(sap_negligible)), found), mass);
}

// Returns d per channel in pixels along the surface.
vec3 sap_d_px(sap_texel own) {
  return profiles[min(own.id, 255u)].d_mm.rgb * (own.reach / sap_footprint(own.depth));
}

// Returns `mean`, or the pixel's own light in channels that do not scatter, and in all channels if d
// is too small. (Rounding would mix them with bright light around.)
vec3 sap_keep_unscattered(vec3 d_px, vec3 light, vec3 mean) {
  float least = max(d_px.r, max(d_px.g, d_px.b)) < copy_below_d_px ? largest_half : 0.0;
  return mix(light, mean, greaterThan(d_px, vec3(least)));
}

// Returns the mean of three lights weighted by mass, as a convex combination that returns equal
// lights unchanged. Unequal lights round, so the result is clamped: almost no light next to glare
// could become negative.
sap_sum sap_blend(vec3 weight_a, vec3 a, vec3 weight_b, vec3 b, sap_sum rest) {
  vec3 total = weight_a + weight_b + rest.mass;
  vec3 scale = 1.0 / max(total, vec3(sap_negligible));
  vec3 mean =
      rest.light + weight_a * scale * (a - rest.light) + weight_b * scale * (b - rest.light);
  return sap_sum(max(mean, vec3(0.0)), total);
}

#endif
