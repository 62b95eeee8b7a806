// Sums over the children of a parent, one after another.
#ifndef DERMIS_SAP_ORDERED_SUMS_GLSL
#define DERMIS_SAP_ORDERED_SUMS_GLSL

#include "sap/sap_down.glsl"

reduction sum_children(sap_parent parent, int layers, sap_seed seed, sap_seed before) {
  reduction sum = no_children;
  const int count = children_a_layer();
  if (shares_children() && layers > 1) { // small enough for the instruction cache
    [[dont_unroll]] for (int row = 0; row < 4; ++row)
      [[unroll]] for (int column = 0; column < 4; ++column)
        add_child(parent, seed, before, 4 * row + column, false, sum);
    sum.first = sum.all;
    if (parent.two)
      [[dont_unroll]] for (int row = 0; row < 4; ++row)
        [[unroll]] for (int column = 0; column < 4; ++column)
          add_child(parent, seed, before, 4 * row + column, true, sum);
  } else {
    [[unroll]] for (int c = 0; c < layers * count; ++c) {
      add_child(parent, seed, before, c % count, c >= count, sum);
      if (c == count - 1)
        sum.first = sum.all;
    }
  }
  return sum;
}

#endif
