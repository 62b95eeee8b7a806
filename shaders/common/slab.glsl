// Light transmitted from the far side. A slab of thickness t that is lit evenly from behind
// transmits the light that the profile carries further than t: for Burley 1/4 e^(-t/d) + 3/4
// e^(-t/3d). Include after the bindings of a kernel with ports thickness, back_lighting and
// scatter_scale.
#ifndef DERMIS_SLAB_GLSL
#define DERMIS_SLAB_GLSL

#include "common/constants_math.glsl"
#include "common/profile.glsl"
#include "common/radius.glsl"
#include "common/sanitise.glsl"


// Returns the transmitted light; 0 if nothing scatters or the thickness is unknown.
vec3 light_through_slab(ivec2 texel, uint id) {
  float scale = has_scatter_scale() ? clean_scatter_scale(texelFetch(scatter_scale_image, texel, 0).r) : 1.0;
  scatter_profile profile = find_profile(id, scale);
  float metres = texelFetch(thickness_image, texel, 0).r;
  vec3 behind = clean_light(texelFetch(back_lighting_image, texel, 0).rgb);
  if (!(profile.d.w > 0.0 && metres >= 0.0)) // NaN compares false
    return vec3(0.0);
  vec3 through = profile_survival(profile, max(metres * mm_per_metre, 1e-6));
  return behind * through * (1.0 - profile_direct(id));
}

#endif
