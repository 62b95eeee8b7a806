// Samples the radius from the mean of the densities of all channels, for channels of different d.
// tests/passes/common/cpu/burley_mixture.cpp mirrors this in fp64.
#ifndef DERMIS_MIXTURE_GLSL
#define DERMIS_MIXTURE_GLSL

#include "common/profile.glsl"

const int mixture_steps = 8;

// Returns equal weights for the channels that scatter.
vec3 mixture_fractions(scatter_profile profile) {
  vec3 fractions = vec3(greaterThan(profile.d.rgb, vec3(0.0)));
  return fractions / max(fractions.r + fractions.g + fractions.b, 1.0);
}

// Returns the radius at survival u of the mixture, for Burley's profile. The logarithm of the
// survival is convex and the narrowest channel's radius is below the root, so that Newton's steps
// approach the root from one side.
radial_sample mixture_sample(scatter_profile profile, float u) {
  u = clamp(u, burley_min_survival, 1.0);
  vec3 fractions = mixture_fractions(profile), d = profile.d.rgb;
  float narrowest = profile.d.w;
  for (int c = 0; c < 3; ++c)
    if (d[c] > 0.0)
      narrowest = min(narrowest, d[c]);
  float last = 50.0 * profile.d.w;
  float r = max(burley_inverse_survival(u, narrowest), 1e-6 * narrowest), density = 1.0;
  for (int i = 0; i <= mixture_steps; ++i) {
    density = dot(fractions, profile_falloff(profile, r) * r);
    if (i == mixture_steps)
      break;
    float survival = dot(fractions, profile_survival(profile, r));
    r = clamp(r + survival * log(survival / u) / density, 1e-6 * narrowest, last);
  }
  return radial_sample(r, density);
}

#endif
