// Sums over the children of a parent as (row 0 + row 1) + (row 2 + row 3), so that invocations
// which sum a row each get the same result as one that sums all.
#ifndef DERMIS_SAP_ROW_SUMS_GLSL
#define DERMIS_SAP_ROW_SUMS_GLSL

#include "sap/sap_down.glsl"

// Adds a row of children: of the first layer, then, if `layers` is 2, of the second.
void add_row(sap_parent parent, int layers, sap_seed seed, sap_seed before, int row,
             inout reduction sum) {
  [[unroll]] for (int column = 0; column < 4; ++column)
    add_child(parent, seed, before, 4 * row + column, false, sum);
  sum.first = sum.all;
  if (layers > 1 && parent.two)
    [[unroll]] for (int column = 0; column < 4; ++column)
      add_child(parent, seed, before, 4 * row + column, true, sum);
}

// A reduction without all_weight as vectors, to be added.
const int sum_vectors = 5;
void to_vectors(reduction sum, out vec4 vectors[sum_vectors]) {
  vectors[0] = vec4(sum.light, sum.light_mass);
  vectors[1] = vec4(sum.mass, sum.area_mass, sum.total, sum.total_flat);
  vectors[2] = vec4(sum.mean_depth, sum.mean_reach, sum.mean_slope);
  vectors[3] = vec4(sum.own.same, sum.own.held, sum.before.same, sum.before.held);
  vectors[4] = vec4(sum.all, sum.first, sum.rise, sum.remains ? 1.0 : 0.0);
}
reduction from_vectors(vec4 vectors[sum_vectors]) {
  return reduction(0.0, vectors[0].a, vectors[1].x, vectors[1].z, vectors[1].w, vectors[2].x,
                   vectors[2].y, vectors[2].zw, vectors[0].rgb, vectors[4].w > 0.0,
                   holding(vectors[3].x, vectors[3].y), holding(vectors[3].z, vectors[3].w),
                   vectors[4].x, vectors[4].y, vectors[1].y, vectors[4].z);
}

reduction sum_children(sap_parent parent, int layers, sap_seed seed, sap_seed before) {
  vec4 pair[sum_vectors], total[sum_vectors];
  [[unroll]] for (int i = 0; i < sum_vectors; ++i)
    pair[i] = total[i] = vec4(0.0);
  [[dont_unroll]] for (int row = 0; row < 4; ++row) {
    reduction sum = no_children;
    add_row(parent, layers, seed, before, row, sum);
    vec4 own[sum_vectors];
    to_vectors(sum, own);
    [[unroll]] for (int i = 0; i < sum_vectors; ++i) {
      pair[i] = (row & 1) == 0 ? own[i] : pair[i] + own[i];
      total[i] = row == 1 ? pair[i] : row == 3 ? total[i] + pair[i] : total[i];
    }
  }
  return from_vectors(total);
}

#endif
