// The seed of a layer on the way down: the child whose plane the layer follows.
#ifndef DERMIS_SAP_SEED_GLSL
#define DERMIS_SAP_SEED_GLSL

#include "sap/sap_children.glsl"

const float hysteresis = 1.02;    // keeps the first seed among equals
// minimum fraction of a plane's depth to which the plane is extrapolated
const float nearest_fraction = 0.25;
// A child that the first layer has used more cannot seed the second layer, because it lies on a
// bend of the first layer's surface.
const float max_used_part = 0.27;

float at_parent(sap_texel child, vec2 offset) {
  return max(child.depth - sap_rise(child.depth, child.slope, offset),
             nearest_fraction * child.depth);
}
bool may_seed(sap_parent parent, sap_texel before, sap_texel child, int c) {
  float off, used = used_by(before, child, offset_of(parent, c), parent.spacing, off);
  return child.id != 0u && (square_pixels || binomial(parent, c) > 0.0) &&
         used <= max_used_part;
}

// Returns the central child: 0 to 3 of the first layer, 4 to 7 of the second.
int central(int i) { return children_across() == 2 ? i : 5 + (i & 1) + 4 * (i >> 1 & 1); }

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
void consider_central(sap_parent parent, int layers, sap_texel near[8],
                      bool may[8], sap_texel seed, bool may_be_seed, int c,
                      inout seed_search found) {
  seed.depth = at_parent(seed, offset_of(parent, c));
  float per_sigma_mm = 1.0 / (sap_sigma * parent.spacing * sap_footprint(seed.depth)),
        support = 0.0;
  [[unroll]] for (int b = 0; b < 4; ++b)
    support += support_of(parent, seed, near[b], may[b], b, per_sigma_mm);
  if (layers > 1 && has_second_children(parent))
    [[unroll]] for (int b = 4; b < 8; ++b)
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
  sap_texel near[8];
  bool may[8];
  [[unroll]] for (int b = 0; b < 4; ++b) {
    near[b] = child_of(parent, central(b), false);
    may[b] = may_seed(parent, before, near[b], central(b));
  }
  if (layers > 1) {
    [[unroll]] for (int b = 4; b < 8; ++b) {
      near[b] = no_texel;
      may[b] = false;
    }
    if (has_second_children(parent)) {
      [[unroll]] for (int b = 4; b < 8; ++b)
        near[b] = child_of(parent, central(b), true);
      [[unroll]] for (int b = 4; b < 8; ++b)
        may[b] = may_seed(parent, before, near[b], central(b));
    }
  }
  seed_search found = seed_search(no_texel, 0.0, 0);
  if (shares_children() && layers > 1) { // small enough for the instruction cache
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
  if (children_across() == 2 || found.best.id != 0u)
    return found.best; // two children along an axis are all central
  const int count = children_a_layer();
  if (shares_children()) {
    [[dont_unroll]] for (int c = 0; c < count; ++c)
      consider_outer(parent, before, c, false, found);
    if (layers > 1 && parent.two)
      [[dont_unroll]] for (int c = 0; c < count; ++c)
        consider_outer(parent, before, c, true, found);
  } else {
    [[unroll]] for (int c = 0; c < layers * count; ++c)
      consider_outer(parent, before, c % count, c >= count, found);
  }
  found.best.depth = at_parent(found.best, offset_of(parent, found.child));
  return found.best;
}

#endif
