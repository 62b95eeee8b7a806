// GPUs: eight invocations compute a texel, so that a tile takes little time if there are too few
// tiles to fill the GPU. To find a seed, each considers one central child. Then four compute the
// first layer and four the second, each a row of the children. Invocations of a subgroup have the
// same part in different texels.
#ifndef DERMIS_SAP_WIDE_TILE_GLSL
#define DERMIS_SAP_WIDE_TILE_GLSL

#include "sap/sap_down_layers.glsl"
#include "sap/sap_row_sums.glsl"
#include "sap/sap_tile_children.glsl"
#include "sap/wide_group.glsl"

const int parts = 8;
shared vec4 exchange[wide_group ? parts * 64 : 1];
shared uint texels_without_seed;

int texel_of_lane() { return int(gl_LocalInvocationIndex & 63u); }
int part_of_lane() { return int(gl_LocalInvocationIndex >> 6u); }
vec4 exchanged(int part) { return exchange[part * 64 + texel_of_lane()]; }
// Waits until all invocations have read the last value.
void give(vec4 value) {
  barrier();
  exchange[gl_LocalInvocationIndex] = value;
  barrier();
}

// Returns the outer child that find_seed() would choose for a texel without a central one: the
// heaviest that may be a seed. Adds 16 if it is of the second layer; -1 if there is none.
int find_outer(sap_parent parent, sap_texel before) {
  vec4 weights;
  int row = part_of_lane() & 3;
  [[unroll]] for (int column = 0; column < 4; ++column) {
    int c = 4 * row + column;
    sap_texel child = child_of(parent, c, part_of_lane() > 3);
    weights[column] =
        may_seed(parent, before, child, c) ? binomial(parent, c) * child.mass : 0.0;
  }
  give(weights);
  float maximum = 0.0;
  int chosen = -1;
  [[dont_unroll]] for (int part = 0; part < parts; ++part) {
    vec4 all = exchanged(part);
    [[unroll]] for (int column = 0; column < 4; ++column)
      if (all[column] > hysteresis * maximum) {
        maximum = all[column];
        chosen = 4 * part + column;
      }
  }
  return chosen;
}

// Returns what find_seed() returns, to all parts of a texel. Every invocation of the group must
// call this.
sap_texel find_seed_together(sap_parent parent, bool inside, sap_texel before) {
  bool second = part_of_lane() > 3;
  int c = central(part_of_lane());
  sap_texel own = child_of(parent, c, second);
  bool may = may_seed(parent, before, own, c);
  give(vec4(may));
  if (gl_LocalInvocationIndex == 0u)
    texels_without_seed = 0u;
  own.depth = at_parent(own, offset_of(parent, c));
  float per_sigma_mm = 1.0 / (sap_sigma * parent.spacing * sap_footprint(own.depth)),
        support = 0.0;
  [[unroll]] for (int b = 0; b < 4; ++b)
    support += support_of(parent, own, child_of(parent, central(b), false),
                          exchanged(b).x > 0.0, b, per_sigma_mm);
  if (parent.two)
    [[unroll]] for (int b = 4; b < 8; ++b)
      support += support_of(parent, own, child_of(parent, central(b), true),
                            exchanged(b).x > 0.0, b, per_sigma_mm);
  give(vec4(may ? support : -1.0));
  int chosen = -1;
  float maximum = 0.0;
  [[unroll]] for (int part = 0; part < parts; ++part) {
    float all = exchanged(part).x;
    if (all >= 0.0 && (chosen < 0 || all > hysteresis * maximum)) {
      maximum = all;
      chosen = part;
    }
  }
  int child = chosen < 0 ? -1 : central(chosen) + (chosen > 3 ? 16 : 0);
  if (inside && child < 0)
    atomicOr(texels_without_seed, 1u);
  barrier();
  if (texels_without_seed != 0u) {
    int outer = find_outer(parent, before);
    child = child < 0 ? outer : child;
  }
  if (child < 0)
    return no_texel;
  sap_texel seed = child_of(parent, child & 15, child > 15);
  seed.depth = at_parent(seed, offset_of(parent, child & 15));
  return seed;
}

// Adds up the sums of the four rows of a layer for the first of them.
reduction add_rows(reduction sum) {
  vec4 total[sum_vectors];
  to_vectors(sum, total);
  int first = part_of_lane() & 4;
  [[unroll]] for (int i = 0; i < sum_vectors; ++i) {
    give(total[i]);
    if (part_of_lane() == first)
      total[i] = (total[i] + exchanged(first + 1)) + (exchanged(first + 2) + exchanged(first + 3));
  }
  return from_vectors(total);
}

shared uint changes[wide_group ? 64 : 1]; // by texel: change_of_first, 0 without a second layer
void compute_tile_together(uvec2 entry, int level) {
  sap_parent parent = parent_in_tile(texel_of_entry(entry, texel_of_lane()), level - 1);
  bool inside = sap_inside(parent.at, level);
  sap_texel before = no_texel, seed = find_seed_together(parent, inside, no_texel);
  sap_texel second_seed = find_seed_together(parent, inside, seed);
  bool second = part_of_lane() > 3, ends = (part_of_lane() & 3) == 0;
  if (second) {
    before = seed;
    seed = second_seed;
  }
  reduction sum = no_children;
  if (inside && seed.id != 0u)
    add_row(parent, 2, seed_of(parent, seed), seed_of(parent, before),
            part_of_lane() & 3, sum);
  sum = add_rows(sum);
  sap_layer layer = no_layer;
  if (ends && inside && seed.id != 0u)
    layer = layer_of_sums(parent, seed, before, sum);
  if (ends && second) {
    changes[texel_of_lane()] = layer.bits.w != 0u ? change_of_first(layer) : 0u;
    if (layer.bits.w != 0u)
      store_layer(parent, level, true, layer);
  }
  barrier();
  if (ends && inside && !second) {
    uint change = changes[texel_of_lane()];
    if (change != 0u)
      layer.bits = with_second(layer.bits, change);
    store_layer(parent, level, false, layer);
  }
}

#endif
