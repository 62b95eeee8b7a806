// Light transmitted from the far side. A slab of thickness t that is lit evenly from behind
// transmits the light that the profile carries further than t: for Burley 1/4 e^(-t/d) + 3/4
// e^(-t/3d).
#ifndef DERMIS_SLAB_GLSL
#define DERMIS_SLAB_GLSL

#include "common/constants_math.glsl"
#include "common/profile.glsl"
#include "common/sanitise.glsl"

// Returns the light transmitted through a slab of profile `id`; 0 if nothing scatters or the
// thickness is unknown. `scale`: the pixel's clean_scatter_scale. `back_lighting` as in the host's
// image.
vec3 light_through_slab(uint id, float scale, float metres, vec3 back_lighting) {
  scatter_profile profile = find_profile(id, scale);
  if (!(profile.d.w > 0.0 && metres >= 0.0)) // NaN compares false
    return vec3(0.0);
  vec3 through = profile_survival(profile, max(metres * mm_per_metre, 1e-6));
  return clean_light(back_lighting) * through * (1.0 - profile_direct(id));
}

#endif
