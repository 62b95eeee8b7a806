// The radial sampler of the widest channel that the settings `inverse` and `weighting` select. Only
// Burley's profile offers several inverses; other models are sampled by their table with the
// table's own density.
#ifndef DERMIS_RADIAL_DRAW_GLSL
#define DERMIS_RADIAL_DRAW_GLSL

#include "common/profile.glsl"
#include "options.glsl"

radial_sample radial_draw(scatter_profile profile, float survival, int inverse, int weighting) {
  if (profile.row != no_radial_row || inverse == INVERSE_POLYNOMIAL) {
    radial_sample radial = profile_sample(profile, survival);
    if (weighting == WEIGHTING_PROFILE && profile.row == no_radial_row)
      radial.density = burley_pdf(radial.r, profile.d.w);
    return radial;
  }
  bool exact = inverse == INVERSE_EXACT;
  float r = exact ? burley_inverse_survival(survival, profile.d.w)
                  : burley_approximate_survival(survival, profile.d.w);
  float density = burley_pdf(r, profile.d.w);
  if (!exact && weighting == WEIGHTING_SAMPLER)
    density /= burley_approximate_weight(survival);
  return radial_sample(r, density);
}

#endif
