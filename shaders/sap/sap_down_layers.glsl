// Both layers of a parent on the way down. Include after sap_down.glsl with two layers, and after
// store_layer(), which writes a layer of a parent to the images of its level, and writes_second(),
// which says whether the level has a second layer.
#ifndef DERMIS_SAP_DOWN_LAYERS_GLSL
#define DERMIS_SAP_DOWN_LAYERS_GLSL

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

// Block shape: computes both layers of a parent. The loop tests at its end, because some drivers
// execute the body of a loop before they find that no invocation is active.
void compute_both(sap_parent parent, int level, bool computes) {
  sap_texel before = no_texel;
  sap_layer first;
  int index = 0, count = computes && writes_second() ? max_layers : 1;
  [[dont_unroll]] do {
    sap_layer layer = reduce(parent, max_layers, before);
    before = layer.seed;
    if (index == 0) {
      first = layer;
    } else if (layer.bits.w != 0u) {
      first.bits = with_second(first.bits, change_of_first(layer));
      store_layer(parent, level, true, layer);
    }
  } while (++index < count);
  store_layer(parent, level, false, first);
}

// Texel shape: computes a parent, whose children are in shared memory.
void compute_parent(sap_parent parent, int level) {
  if (!sap_inside(parent.at, level))
    return;
  sap_layer first = reduce(parent, max_layers, no_texel);
  if (writes_second() && (parent.two || first.remains && parent.splits)) {
    sap_layer second = reduce(parent, max_layers, first.seed);
    if (second.bits.w != 0u) {
      first.bits = with_second(first.bits, change_of_first(second));
      store_layer(parent, level, true, second);
    }
  }
  store_layer(parent, level, false, first);
}

#endif
