// What subsurface.residual keeps of a pixel beside its ratio: view depth in metres, profile, pattern of the light that the
// ratio was learned in (a logarithm, so that halves hold it whatever the unit of light), mean square of how far patterns stray
// from it in light that stays. Include after reproject.glsl.
#ifndef DERMIS_RESIDUAL_GLSL
#define DERMIS_RESIDUAL_GLSL

const float mm_per_metre = 1000.0; // halves hold a depth within .05 % from a tenth of a millimetre to 65 km
const float min_light = 1e-6;    // of the pyramid; a ratio to less says nothing
const float never_lit = -128.0;    // instead of a pattern
const float stray_width = 2.0;     // of what strays, in its root mean square: 95 % of a normal distribution
const float sqrt_pi = 1.7724539;

vec2 residual_surface_before(vec4 kept) { return vec2(kept.r * mm_per_metre, kept.g); }

float residual_luminance(vec3 light) { return dot(light, vec3(0.2126, 0.7152, 0.0722)); } // Rec. 709
bool is_lit(vec3 light) { return residual_luminance(light) > min_light; }
float brightness(vec3 light) { return log(max(residual_luminance(light), min_light)); }

bool has_pattern(vec2 kept) { return kept.x > 0.5 * never_lit; }

// Pattern and square of strays that the frame before kept; never_lit where it knew neither.
vec2 pattern_before(history_taps taps) {
  vec3 sum = vec3(0.0);
  for (int i = 0; i < 4; ++i)
    if (taps.weight[i] > 0.0) {
      vec2 kept = texelFetch(place_image, previous_texel(taps.first + ivec2(i & 1, i >> 1)), 0).ba;
      if (has_pattern(kept))
        sum += taps.weight[i] * vec3(kept, 1.0);
    }
  return sum.z > 0.0 ? sum.xy / sum.z : vec2(never_lit, 0.0);
}

// Deviation of a logarithm, where surfaces that stray do so within `common_tolerance` without.
float tolerance_of(float common_tolerance, float stray) {
  return sqrt(common_tolerance * common_tolerance + stray_width * stray_width * stray);
}

#endif
