// Removes NaN, infinities and negative light from images of the host.
#ifndef DERMIS_SANITISE_GLSL
#define DERMIS_SANITISE_GLSL

// NaN compares false; Inf becomes finite.
float clean_light(float x) { return x > 0.0 ? min(x, 65504.0) : 0.0; }
vec3 clean_light(vec3 v) { return vec3(clean_light(v.x), clean_light(v.y), clean_light(v.z)); }

float clean_albedo(float x) { return x > 0.0 ? min(x, 1.0) : 0.0; }
vec3 clean_albedo(vec3 v) { return vec3(clean_albedo(v.x), clean_albedo(v.y), clean_albedo(v.z)); }

float clean_importance(float x) { return clean_albedo(x); }

#endif
