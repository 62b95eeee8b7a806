// What subsurface.residual keeps of a pixel beside its ratio: view depth in metres, profile, pattern of the light that the
// ratio was learned in, brightness when it was last lit. Logarithms, so that halves hold them whatever the unit of light.
#ifndef DERMIS_RESIDUAL_GLSL
#define DERMIS_RESIDUAL_GLSL

const float mm_per_metre = 1000.0; // halves hold a depth within .05 % from a tenth of a millimetre to 65 km
const float least_light = 1e-6;    // of the pyramid; a ratio to less says nothing
const float never_lit = -64.0;     // more than its logarithm

vec2 residual_surface_before(vec4 kept) { return vec2(kept.r * mm_per_metre, kept.g); }

float residual_luminance(vec3 light) { return dot(light, vec3(0.2126, 0.7152, 0.0722)); } // Rec. 709
bool is_lit(vec3 light) { return residual_luminance(light) > least_light; }
float brightness(vec3 light) { return log(max(residual_luminance(light), least_light)); }

#endif
