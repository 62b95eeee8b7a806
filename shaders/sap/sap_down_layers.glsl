// Both layers of a parent on the way down.
#ifndef DERMIS_SAP_DOWN_LAYERS_GLSL
#define DERMIS_SAP_DOWN_LAYERS_GLSL

#include "sap/sap_down.glsl"

// The kernel that includes this file defines both functions.
// Returns whether the level has a second layer.
bool writes_second();
// Writes a layer of a parent to the images of its level.
void store_layer(sap_parent parent, int level, bool second, sap_layer layer);

// Returns what a second layer changes in the bits of the first: `held` of the first layer and
// `lost`. Not 0.
uint change_of_first(sap_layer second) {
  return sap_second_bit | second.held_before << 4 | second.bits.y & sap_max_lost;
}
uvec4 with_second(uvec4 first, uint change) {
  uvec4 bits = sap_with_held(first, change >> 4 & sap_max_held, change & sap_max_lost);
  bits.x |= sap_second_bit;
  return bits;
}

// Computes a parent, whose children are in shared memory.
void compute_parent(sap_parent parent, int level) {
  if (!sap_inside(parent.at, level))
    return;
  sap_layer first = reduce(parent, 2, no_texel);
  if (writes_second() && (parent.two || first.remains && parent.splits)) {
    sap_layer second = reduce(parent, 2, first.seed);
    if (second.bits.w != 0u) {
      first.bits = with_second(first.bits, change_of_first(second));
      store_layer(parent, level, true, second);
    }
  }
  store_layer(parent, level, false, first);
}

#endif
