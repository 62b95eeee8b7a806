// Light at the precision of the setting `storage`, which all passes of a pyramid share.
#ifndef DERMIS_SAP_STORAGE_GLSL
#define DERMIS_SAP_STORAGE_GLSL

#include "common/half.glsl"
#include "sap/sap.glsl"

// Returns whether `storage` is full. The kernel that includes this file defines the function.
bool stores_full();

// Rounds light as it is stored.
vec4 sap_stored(vec4 light) { return stores_full() ? light : round_to_half(light); }
// Returns the light of a texel from `surface` and its texel of `light`.
vec4 sap_stored_light(uvec4 bits, vec4 stored) { return sap_light(bits, stored, stores_full()); }

#endif
