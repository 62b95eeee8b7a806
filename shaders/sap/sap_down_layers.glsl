// Both layers of a parent on the way down. Include after sap_down.glsl with two layers, and after
// store_layer(), which writes a layer of a parent to the images of its level.
#ifndef DERMIS_SAP_DOWN_LAYERS_GLSL
#define DERMIS_SAP_DOWN_LAYERS_GLSL

// Computes both layers of a parent. In the texel shape the first layer is known if no child has two
// layers. The loop tests at its end, because some drivers execute the body of a loop before they
// find that no invocation is active.
void compute_both(sap_parent parent, int level, sap_layer first, bool computes) {
  bool known = texel_shape && !parent.two;
  sap_texel before = no_texel;
  if (known)
    before = first.seed;
  int index = known ? 1 : 0, count = computes ? max_layers : 1;
  [[dont_unroll]] do {
    sap_layer layer = reduce(parent, max_layers, before);
    before = layer.seed;
    if (index == 0) {
      first = layer;
    } else if (layer.bits.w != 0u) {
      first.bits.x |= sap_second_bit;
      store_layer(parent, level, true, layer);
    }
  } while (++index < count);
  store_layer(parent, level, false, first);
}

// Texel shape: computes a parent, whose children are in shared memory.
void compute_parent(sap_parent parent, int level) {
  if (!sap_inside(parent.at, level))
    return;
  sap_layer layer = sap_layer(vec4(0.0), uvec4(0u), no_texel, true);
  if (!parent.two)
    layer = reduce(parent, 1, no_texel);
  if (layer.remains)
    compute_both(parent, level, layer, true);
  else
    store_layer(parent, level, false, layer);
}

#endif
