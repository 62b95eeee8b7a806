// Several levels in the layers of one array image, each with the border and the addresses of its
// own image. A level has four layers: surface, second surface, light, second light. Light is stored
// as bits, because a kernel that writes and reads an image must name one format.
#ifndef DERMIS_SAP_LEVELS_GLSL
#define DERMIS_SAP_LEVELS_GLSL

#include "sap/sap_storage.glsl"

const int surface_in_levels = 0, light_in_levels = 2; // the second layer follows each

// Returns the place of a texel. `above`: number of levels of the image that are finer.
ivec3 place_in_levels(ivec2 address, int above, int content) {
  return ivec3(address, 4 * above + content);
}

uvec4 light_to_bits(vec4 light) {
  return stores_full() ? floatBitsToUint(light)
                       : uvec4(packHalf2x16(light.rg), packHalf2x16(light.ba), 0u, 0u);
}
vec4 light_from_bits(uvec4 bits) {
  return stores_full() ? uintBitsToFloat(bits)
                       : vec4(unpackHalf2x16(bits.x), unpackHalf2x16(bits.y));
}

#endif
