// Both layers of a texel on the way up. Include after sap_climb.glsl with two own layers, and after
// store_scattered(), which stores the bits of a layer.
#ifndef DERMIS_SAP_UP_LAYERS_GLSL
#define DERMIS_SAP_UP_LAYERS_GLSL

// Computes the layers of the texel at `place`. The loop tests at its end, because some drivers
// execute the body of a loop before they find that no invocation is active.
void compute_layers(sap_place place, int level, bool smooth_level, bool last) {
  uvec4 first = near_bits(place, near_centre);
  sap_texel own = sap_unpack(first);
  vec3 light = light_near(place, level, near_centre).rgb;
  int layer = 0, layers = has_second_near(first) ? 2 : 1;
  [[dont_unroll]] do {
    uvec4 bits = uvec4(0u);
    if (own.id != 0u)
      bits = climb(place, level, own, light, SAP_OWN_LAYERS, smooth_level, last);
    store_scattered(place, level, layer, bits);
    if (!texel_shape || layers > 1) {
      own = sap_unpack(second_near_bits(place, level, near_centre));
      light = second_light_near(place, level, near_centre).rgb;
    }
  } while (++layer < layers);
}

#endif
