// Host images are not trusted: NaN, infinities and negative light end here.
#ifndef DERMIS_SANITISE_GLSL
#define DERMIS_SANITISE_GLSL

float clean_light(float x) { return x > 0.0 ? min(x, 65504.0) : 0.0; } // NaN compares false; Inf becomes finite
vec3 clean_light(vec3 v) { return vec3(clean_light(v.x), clean_light(v.y), clean_light(v.z)); }

float clean_albedo(float x) { return x > 0.0 ? min(x, 1.0) : 0.0; }
vec3 clean_albedo(vec3 v) { return vec3(clean_albedo(v.x), clean_albedo(v.y), clean_albedo(v.z)); }

#endif
