// The seed of a layer on the way down: the child whose plane the layer follows. Include from
// sap_down.glsl, after child_of() and may_seed().
#ifndef DERMIS_SAP_SEED_GLSL
#define DERMIS_SAP_SEED_GLSL

// Returns the central child: 0 to 3 of the first layer, 4 to 7 of the second.
int central(int i) {
#ifdef SAP_BOX
  return i;
#else
  return 5 + (i & 1) + 4 * (i >> 1 & 1);
#endif
}

struct seed_search {
  sap_texel best;
  float maximum;
  int child;
};
void consider_outer(sap_parent parent, sap_texel before, int c, bool second,
                    inout seed_search found) {
  sap_texel child = child_of(parent, c, second);
  float weight = may_seed(parent, before, child, c) ? binomial(parent, c) * child.mass : 0.0;
  if (weight > hysteresis * found.maximum)
    found = seed_search(child, weight, c);
}

// Returns the support of a seed's plane by central child b.
float support_of(sap_parent parent, sap_texel seed, sap_texel near, bool may, int b,
                 float per_sigma_mm) {
  float off = sap_off_plane(seed, near, offset_of(parent, central(b))) * per_sigma_mm;
  return near.id == seed.id && may ? exp2(sap_factor(sap_depth_width) * off * off) : 0.0;
}
// Compares the plane of central child c with the best one so far. `near` and `may`: the central
// children, and whether each can be a seed.
void consider_central(sap_parent parent, int layers, sap_texel near[4 * max_layers],
                      bool may[4 * max_layers], sap_texel seed, bool may_be_seed, int c,
                      inout seed_search found) {
  seed.depth = at_parent(seed, offset_of(parent, c));
  float per_sigma_mm = 1.0 / (sap_sigma * parent.spacing * sap_footprint(seed.depth)),
        support = 0.0;
  [[unroll]] for (int b = 0; b < 4; ++b)
    support += support_of(parent, seed, near[b], may[b], b, per_sigma_mm);
  if (layers > 1 && has_second_children(parent))
    [[unroll]] for (int b = 4; b < 4 * max_layers; ++b)
      support += support_of(parent, seed, near[b], may[b], b, per_sigma_mm);
  if (may_be_seed && (found.best.id == 0u || support > hysteresis * found.maximum)) {
    found.best = seed;
    found.maximum = support;
  }
}

// Returns the child whose plane has the most support among the central children; without a central
// child, the outer child with the largest weight. Its depth is the depth of its plane at the
// parent; id 0 means no child.
sap_texel find_seed(sap_parent parent, int layers, sap_texel before) {
  sap_texel near[4 * max_layers];
  bool may[4 * max_layers];
  [[unroll]] for (int b = 0; b < 4; ++b) {
    near[b] = child_of(parent, central(b), false);
    may[b] = may_seed(parent, before, near[b], central(b));
  }
  if (layers > 1) {
    [[unroll]] for (int b = 4; b < 4 * max_layers; ++b) {
      near[b] = no_texel;
      may[b] = false;
    }
    if (has_second_children(parent)) {
      [[unroll]] for (int b = 4; b < 4 * max_layers; ++b)
        near[b] = child_of(parent, central(b), true);
      [[unroll]] for (int b = 4; b < 4 * max_layers; ++b)
        may[b] = may_seed(parent, before, near[b], central(b));
    }
  }
  seed_search found = seed_search(no_texel, 0.0, 0);
  if (texel_shape && layers > 1) { // small enough for the instruction cache
    [[dont_unroll]] for (int a = 0; a < 4; ++a) {
      sap_texel seed = child_of(parent, central(a), false);
      bool may_be_seed = may_seed(parent, before, seed, central(a));
      consider_central(parent, layers, near, may, seed, may_be_seed, central(a), found);
    }
    if (parent.two)
      [[dont_unroll]] for (int a = 0; a < 4; ++a) {
        sap_texel seed = child_of(parent, central(a), true);
        bool may_be_seed = may_seed(parent, before, seed, central(a));
        consider_central(parent, layers, near, may, seed, may_be_seed, central(a), found);
      }
  } else {
    [[unroll]] for (int a = 0; a < 4 * layers; ++a)
      consider_central(parent, layers, near, may, near[a], may[a], central(a), found);
  }
#ifndef SAP_BOX
  if (found.best.id != 0u)
    return found.best;
  if (texel_shape) {
    [[dont_unroll]] for (int c = 0; c < children_a_layer; ++c)
      consider_outer(parent, before, c, false, found);
    if (layers > 1 && parent.two)
      [[dont_unroll]] for (int c = 0; c < children_a_layer; ++c)
        consider_outer(parent, before, c, true, found);
  } else {
    [[unroll]] for (int c = 0; c < layers * children_a_layer; ++c)
      consider_outer(parent, before, c % children_a_layer, c >= children_a_layer, found);
  }
  found.best.depth = at_parent(found.best, offset_of(parent, found.child));
#endif
  return found.best;
}

#endif
