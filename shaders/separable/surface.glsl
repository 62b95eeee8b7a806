// Light and view depth between the passes of the separable technique.
#ifndef DERMIS_SEPARABLE_SURFACE_GLSL
#define DERMIS_SEPARABLE_SURFACE_GLSL

#include "common/environment.glsl"

// View depth where no subsurface is visible: infinite.
float no_surface() { return uintBitsToFloat(0x7f800000u); }

bool is_surface(float depth) { return depth < largest_depth_mm; } // false for NaN

// The alpha channel of light holds the profile id, exactly. Ids beyond the table are one profile.
float stored_profile(uint id) { return float(min(id, 255u)); }

#endif
