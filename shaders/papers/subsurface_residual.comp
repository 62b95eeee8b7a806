#version 460
// Multiplies the pyramid's light by the moving mean of the ratio of samples to it, where confidence
// is low. The ratio does not depend on how bright the light is, so it does not lag behind
// flickering light. The ratio depends on the pattern of light and counts for less if the pattern
// changes.
// A pixel samples in one of 4 or of 16 frames, depending on its confidence and its tile. While it
// has little history, it samples in each frame with twice as many samples.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "papers/subsurface_residual.bindings.glsl"
#include "common/environment.glsl"
#include "common/tiles.glsl"
#include "common/half.glsl"
#include "common/reproject.glsl"
#include "sap/sap_samples.glsl"
#include "papers/residual.glsl"

bool near_written(ivec2 at) { return class_of_tile(classes_data[sap_tile(at)]) != class_none; }
uvec4 level_surface(int level, ivec2 address) {
  return fetch_level(surface_1_image, surface_2_image, surface_3_image, surface_4_image,
                     surface_5_image, level, address);
}
vec4 level_light(int level, ivec2 address) {
  return fetch_level(light_1_image, light_2_image, light_3_image, light_4_image, light_5_image,
                     level, address);
}

const float largest_kept = 8.0;  // maximum of a sampled ratio
const float largest_ratio = 4.0; // maximum factor on light
const float deviation_rate = 0.1;    // rate of the moving mean of the squared deviation
const float max_squared_deviation =
    0.3; // maximum deviation of a logarithm that counts in this mean
const float new_light_factor =
    0.5; // factor on alpha where light has just appeared that may not stay
const float least_part = 0.1; // least part of the kernel on the surface that counts
const float sample_noise = 0.4; // squared noise of a ratio, times the number of its samples
// The same for young histories, of the ratio of one pixel and of the mean with those around it.
const float single_noise = 0.9, averaged_noise = 0.05;
// Factor on the estimated noise of a surface that ends nearby, where samples are noisier. Smaller
// ones make light worse where the pyramid is right.
const float edge_factor = 1.5;
// Inside a surface the factor is inner_factor * d in pixels, within this range. If d is wide, the
// true ratios of neighbours are alike, so their differences are noise, and four of them may be
// small by chance. If d is small, the true ratios differ, too, and the noise is overestimated.
const float inner_factor = 0.5, min_inner_factor = 1.2, max_inner_factor = 2.0;
const float unknown_noise = 1e3; // squared noise of a ratio without neighbours
// Maximum distance of a neighbour from the tangent plane, in pixel sides.
const float plane_distance = 2.0;

// Returns how much a ratio applies to light whose pattern differs by `off` from the pattern in
// which the ratio was learned. The result is the odds of unchanged light against light that changed
// and looks alike. A pixel's pattern is its log luminance minus the change of the whole picture: a
// flash does not change it, but a shadow or light from another direction does.
float agreement_weight(float off, float tolerance, float odds) {
  float same = odds * exp(-off * off / (tolerance * tolerance));
  return same / (1.0 + same);
}

// Returns the part, 0 to 1, of a ratio's distance from 1 that is not noise: where the pyramid is
// right, samples only add noise. mean: ratio and its squared noise, as mean_ratio() returns them.
// count: number of its samples. In a `young` history too few ratios have been measured, so the
// noise is also estimated from the number of samples.
float part_beyond_noise(vec4 mean, float count, bool averaged, bool young) {
  float off = residual_luminance(mean.rgb - 1.0), square = max(off * off, 1e-12);
  float part = max(1.0 - mean.a / square, 0.0);
  float expected = (averaged ? averaged_noise : single_noise) / max(count, 1.0);
  return young ? min(part, square / (square + expected)) : part;
}

previous_position place_of(ivec2 pixel, sap_texel own) {
  return has_velocity() && own.depth > 0.0
             ? reproject(vec2(pixel), own.depth,
                         texelFetch(velocity_image, texel_of(pixel), 0).rgb)
             : reproject(vec2(pixel), own.depth);
}
float tolerance_around(previous_position place, sap_texel own) {
  return depth_tolerance(place.depth, length(own.slope) * sap_footprint(own.depth));
}

// rgb: ratio, a: number of its samples, weighted by the part of the kernel on the surface.
vec4 ratio_before(history_taps taps) {
  vec4 sum = vec4(0.0);
  for (int i = 0; i < 4; ++i)
    if (taps.weight[i] > 0.0)
      sum += taps.weight[i] * texelFetch(ratio_image, previous_texel(tap_pixel(taps, i)), 0);
  return sum;
}

// Adds the ratio at `at`, next to `ratio`, to the sum of ratios and weights. Ratios that differ by
// more than their noise count little. `off` receives the difference of their luminances. Returns
// false, and adds nothing, if `at` does not show profile `id` at `depth` (mm).
bool add_ratio(ivec2 at, vec4 ratio, float depth, uint id, float tolerance, inout vec4 sum,
               out float off) {
  off = 0.0;
  if (!inside_previous(at) ||
      !shows_surface(residual_surface_before(place_image, at), previous_position(vec2(at), depth),
                     id, tolerance))
    return false;
  vec4 other = texelFetch(ratio_image, previous_texel(at), 0);
  off = residual_luminance(other.rgb - ratio.rgb);
  float weight = exp(-off * off * ratio.a / sample_noise) * min(other.a / ratio.a, 1.0);
  sum += weight * vec4(other.rgb, 1.0);
  return true;
}

// Returns the mean with the ratios of the neighbours that lie on the tangent plane. (The tolerance
// of the history would let other layers of a dithered surface through.)
// a: squared noise of its luminance, from the second differences along the axes, to which an even
// change of the ratio adds nothing. Without any the noise is unknown, and the ratio does not apply.
vec4 mean_ratio(vec4 ratio, previous_position place, sap_texel own) {
  const ivec2 axes[4] = ivec2[](ivec2(1, 0), ivec2(0, 1), ivec2(1, 1), ivec2(1, -1));
  vec4 sum = vec4(ratio.rgb, 1.0);
  bool inner = false; // whether all axes stay on the surface
  vec2 bends = vec2(0.0); // squares of the second differences, and their number
  ivec2 centre = ivec2(floor(place.pixel + 0.5));
  // A velocity may not tell how the depth changed, so the depth is the one kept at the centre.
  float depth = place.depth + sap_rise(own.depth, own.slope, vec2(centre) - place.pixel);
  if (has_velocity() && inside_previous(centre)) {
    vec2 kept = residual_surface_before(place_image, centre);
    if (shows_surface(kept, place, own.id, tolerance_around(place, own)))
      depth = kept.x;
  }
  float tolerance =
      plane_distance * sap_footprint(own.depth) + reproject_depth_rounding * place.depth;
  // The next eight pixels are read only where an axis leaves the surface.
  for (int i = 0; i < 8 && !inner; ++i) {
    ivec2 step = axes[i & 3] * (1 + i / 4);
    float rise = sap_rise(own.depth, own.slope, vec2(step)), before, after;
    bool has_before = add_ratio(centre - step, ratio, depth - rise, own.id, tolerance, sum, before),
         has_after = add_ratio(centre + step, ratio, depth + rise, own.id, tolerance, sum, after);
    float bend = before + after;
    bends += has_before && has_after ? vec2(bend * bend, 1.0) : vec2(0.0);
    inner = inner || (i == 3 && bends.y == 4.0);
  }
  // A sixth of the mean square is a ratio's squared noise. Few squares may be small by chance.
  float variance = bends.y > 0.0 ? bends.x / (6.0 * bends.y) : unknown_noise;
  float d_px = profiles[min(own.id, 255u)].d_mm.w * own.reach / sap_footprint(own.depth);
  variance *= inner ? clamp(inner_factor * d_px, min_inner_factor, max_inner_factor)
                    : edge_factor * (1.0 + 4.0 / max(bends.y, 1.0));
  return vec4(sum.rgb / sum.a, variance / sum.a);
}

// Returns whether the tile takes samples in this frame. Tiles take turns: within 2x2 tiles each is
// sampled in every fourth frame, within 4x4 tiles in every sixteenth. Frame indices may advance by
// any number, so frames of the view count.
bool is_turn(ivec2 tile, float confidence) {
  if (confidence < settings.often_below)
    return (uint(tile.x & 1) + 2u * uint(tile.y & 1)) == (frame.view_frame & 3u);
  return (uint(tile.x & 3) + 4u * uint(tile.y & 3)) == (frame.view_frame & 15u);
}

void main() {
  ivec2 pixel;
  bool copy_only;
  uint listed = listed_tile();
  if (listed >= tiles_data[0] || !pixel_of_tile(tiles_data[1u + listed], pixel, copy_only))
    return;
  ivec2 texel = texel_of(pixel);
  vec4 light = texelFetch(scattered_image, texel, 0);
  sap_texel own = sap_unpack(texelFetch(surface_image, texel, 0));
  vec4 ratio = vec4(1.0, 1.0, 1.0, 0.0);
  int count = 0;
  bool lost = false;
  previous_position place = previous_position(vec2(0.0), 0.0);
  vec2 kept = vec2(never_lit, 0.0); // x: learned pattern, y: squared deviation
  if (own.id != 0u && !copy_only) {
    // change of log luminance, odds that patterns agree, their tolerance
    vec4 all = texelFetch(luminance_change_image, ivec2(0), 0);
    float pattern = log_luminance(light.rgb) - all.r, agreement = all.g / (1.0 + all.g);
    bool lit = is_lit(light.rgb), turn = is_turn(pixel >> 3, light.a);
    if (history_usable() && own.depth > 0.0) {
      place = place_of(pixel, own);
      history_taps taps = find_history(place_image, place, own.id, tolerance_around(place, own));
      lost = taps.weight == vec4(0.0);
      if (!lost)
        ratio = ratio_before(taps);
      kept = pattern_before(place_image, taps);
      // History interpolated between texels is blurred, and so differs at each edge from the new
      // pattern.
      bool resampled = !any(equal(taps.weight, vec4(1.0)));
      float off = min(abs(pattern - kept.x), max_squared_deviation);
      if (lit)
        kept.y = mix(kept.y, resampled ? off * off : 0.0, deviation_rate * agreement);
    }
    if (!has_pattern(kept))
      kept = vec2(lit ? pattern : never_lit, 0.0);
    // Light that appeared suddenly may vanish suddenly: keeps the earlier state a little longer.
    float alpha = settings.alpha * mix(new_light_factor, 1.0, agreement);
    bool first = ratio.a == 0.0;
    float n = float(settings.samples);
    // A moving mean of weight alpha is worth (2 - alpha) / alpha estimates. A half may round down.
    float most = (2.0 - settings.alpha) / settings.alpha * n;
    float eager = min(float(settings.eager) * n, 0.95 * most);
    if (light.a >= settings.below) {
      // No ratio is learned here; patterns are, so that they can be compared.
      ratio.a *= 1.0 - 0.25 * settings.alpha;
      if (turn && lit)
        kept.x = mix(kept.x, pattern, alpha);
    } else if (any(greaterThan(light.rgb, vec3(min_light))) && // not in the dark
               (turn || ratio.a < eager)) {
      count = ratio.a < eager ? 2 * settings.samples : settings.samples;
      // Frames in which the tile samples are consecutive in the sequence; other frames are far from
      // them.
      uint index = (frame.view_frame >> 2) + (frame.view_frame & 3u) * 0x9e3779u;
      uvec2 offset = r2_point(offset_from_hash(pcg3d16(uvec3(pixel, 0u)).xy), index);
      vec3 own_light = pixel_light_of_level_0(surface_image, light_image, texel);
      vec3 mass;
      vec3 sampled = sap_sampled_light(surface_image, light_image, pixel, own, own_light, offset,
                                       count, settings.lod_bias, mass);
      vec3 found = clamp(sampled / max(light.rgb, vec3(min_light)), vec3(0.0), vec3(largest_kept));
      found = mix(vec3(1.0), found, greaterThan(light.rgb, vec3(min_light)));
      // The mean of few samples is biased where a part of the kernel leaves the surface. With
      // frames weighted by the part on the surface, the running mean is a ratio of sums, whose bias
      // falls with the number of frames.
      float part = clamp(residual_luminance(mass), least_part, 1.0), counted = part * float(count);
      float weight = max(part * alpha, counted / (ratio.a + counted));
      ratio.rgb = mix(ratio.rgb, found, weight);
      kept.x = mix(kept.x, pattern, weight);
      ratio.a = min(ratio.a + counted, most);
    }
    float pattern_agreement =
        first ? 1.0 : agreement_weight(pattern - kept.x, tolerance_of(all.b, kept.y), all.g);
    float fraction = sample_fraction(light.a, ratio.a, settings.sample_weight);
    bool averaged = fraction > 0.0 && !first && !lost && place.depth > 0.0;
    vec4 mean = averaged ? mean_ratio(ratio, place, own) : vec4(ratio.rgb, 0.0);
    float beyond = part_beyond_noise(mean, ratio.a, averaged, ratio.a < 3.0 * n);
    light.rgb *= 1.0 + pattern_agreement * fraction * beyond *
                           (min(mean.rgb, vec3(largest_ratio)) - 1.0);
  }
  imageStore(refined_image, texel, round_to_half(light));
  imageStore(ratio_out_image, texel, round_to_half(ratio));
  imageStore(place_out_image, texel,
             round_to_half(vec4(own.depth / mm_per_metre, float(own.id), kept)));
  if (has_sampling())
    imageStore(sampling_image, texel, vec4(float(count), ratio.a, light.a, lost ? 1.0 : 0.0));
}
