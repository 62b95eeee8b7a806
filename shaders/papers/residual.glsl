// State that subsurface.residual keeps of a pixel in addition to its ratio: view depth in metres,
// profile, pattern, and mean square deviation. The pattern is the logarithm of the light in which
// the ratio was learned, so that halves can hold the value in any unit of light. The deviation is
// that of later patterns while light is stable.
#ifndef DERMIS_RESIDUAL_GLSL
#define DERMIS_RESIDUAL_GLSL

#extension GL_EXT_samplerless_texture_functions : require

#include "common/constants_math.glsl"
#include "common/reproject.glsl"

// Halves hold a depth within 0.05 % from 0.1 mm to 65 km.
const float min_light = 1e-6;    // light of the pyramid below which a ratio is meaningless
const float never_lit = -128.0;    // stored instead of a pattern
// Width of the deviation in units of its root mean square: 95 % of a normal distribution.
const float deviation_width = 2.0;
const float sqrt_pi = 1.7724539;

// `place_image`: the image that keeps the state.
vec2 residual_surface_before(texture2D place_image, ivec2 pixel) {
  vec2 kept = texelFetch(place_image, previous_texel(pixel), 0).rg;
  return vec2(kept.r * mm_per_metre, kept.g);
}

history_taps find_history(texture2D place_image, previous_position place, uint id,
                          float tolerance) {
  history_taps taps = taps_around(place);
  for (int i = 0; i < 4; ++i)
    if (taps.weight[i] > 0.0 &&
        !shows_surface(residual_surface_before(place_image, tap_pixel(taps, i)), place, id,
                       tolerance))
      taps.weight[i] = 0.0;
  return normalised_taps(taps);
}

// Rec. 709
float residual_luminance(vec3 light) { return dot(light, luminance_weights); }
bool is_lit(vec3 light) { return residual_luminance(light) > min_light; }
float log_luminance(vec3 light) { return log(max(residual_luminance(light), min_light)); }

bool has_pattern(vec2 kept) { return kept.x > 0.5 * never_lit; }

// Returns the pattern and the squared deviation that the previous frame kept; never_lit if it knew
// neither.
vec2 pattern_before(texture2D place_image, history_taps taps) {
  vec3 sum = vec3(0.0);
  for (int i = 0; i < 4; ++i)
    if (taps.weight[i] > 0.0) {
      vec2 kept = texelFetch(place_image, previous_texel(tap_pixel(taps, i)), 0).ba;
      if (has_pattern(kept))
        sum += taps.weight[i] * vec3(kept, 1.0);
    }
  return sum.z > 0.0 ? sum.xy / sum.z : vec2(never_lit, 0.0);
}

// Returns the deviation of a logarithm for a surface with squared deviation `stray`.
// `common_tolerance` applies without such a deviation.
float tolerance_of(float common_tolerance, float squared_deviation) {
  return sqrt(common_tolerance * common_tolerance +
              deviation_width * deviation_width * squared_deviation);
}

#endif
