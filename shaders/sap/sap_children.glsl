// The children of a parent on the way down: their places and weights, and which of them lie on a
// surface.
#ifndef DERMIS_SAP_CHILDREN_GLSL
#define DERMIS_SAP_CHILDREN_GLSL

#include "sap/sap.glsl"

struct sap_parent {
  ivec2 at;   // texel of its level
  int finer;  // level of its children
  float spacing; // of the children, in pixels; geometric mean of both axes
  vec2 distances; // between the children, in pixels; 0 along an axis that the level does not halve
  // Children in shared memory: place of the first one; its position if pixels are not square.
  int base;
  bool two;   // a child has two layers
  bool splits; // the parent may have two layers
};
const sap_texel no_texel = sap_texel(0.0, vec2(0.0), 0.0, 0.0, 0u);

// The kernel that includes this file defines the next five functions.
// Returns the children of a parent along an axis: 4, whose weights are [1 3 3 1], or 2 of equal
// weight.
int children_across();
// Returns whether children are in shared memory and not in registers. Their code is small, for the
// instruction cache, and has more branches.
bool shares_children();
// Returns whether children can have second layers.
bool finer_has_layers();
// Return child c of the parent, of its second layer if `second`. The id is 0 if there is none.
sap_texel child_of(sap_parent parent, int c, bool second);
vec4 light_of(sap_parent parent, int c, bool second, uint id);

int children_a_layer() { return children_across() * children_across(); }
// Children in registers are all read, so that no branch depends on them.
bool has_second_children(sap_parent parent) { return parent.two || !shares_children(); }

// Prepares the parent at a texel; its children are yet to be read.
sap_parent parent_at(ivec2 at, int finer) {
  vec2 distances = sap_spacings(finer) * vec2(step_from_level(finer) - 1);
  return sap_parent(at, finer, sap_spacing(finer), distances, 0, false, true);
}
// The parents of a block of 2x2 share children. Returns the index of a child of the block, row by
// row.
int shared_child(int parent, int child, int finer) {
  ivec2 step = step_from_level(finer);
  return (step.y * (parent / 2) + child / children_across()) * (children_across() + 2) +
         step.x * (parent % 2) + child % children_across();
}

ivec2 place_of_child(int child) {
  return ivec2(child, child / children_across()) & (children_across() - 1);
}
vec2 offset_of(sap_parent parent, int child) {
  return (vec2(place_of_child(child)) - 0.5 * float(children_across() - 1)) * parent.distances;
}
// Returns the weight of a child along an axis; an axis that is not halved has one child.
float binomial(int place, bool halves) {
  if (children_across() == 2)
    return halves ? 0.5 : float(place == 0);
  return halves ? (place % 3 == 0 ? 0.125 : 0.375) : float(place == 1);
}
float binomial(sap_parent parent, int child) {
  ivec2 place = place_of_child(child);
  bvec2 halves = greaterThan(step_from_level(parent.finer), ivec2(1));
  return binomial(place.x, halves.x) * binomial(place.y, halves.y);
}

// Returns the fraction of a child of a seed's profile that lies on the surface of the seed.
// `depth_step` and `off` receive the difference of their depths and the child's distance from the
// surface in sigmas.
float kept_of(sap_texel seed, sap_texel child, vec2 offset, float per_sigma_mm,
              out float depth_step, out float off) {
  depth_step = (child.depth - seed.depth) * per_sigma_mm;
  off =
      sap_nearer(depth_step - sap_rise(seed.depth, seed.slope, offset) * per_sigma_mm, depth_step);
  return exp2(sap_factor(sap_depth_width) * off * off);
}
// Returns the fraction of a child that the layer with seed `before` has used; 0 without such a
// layer (id 0). `off` receives the child's distance from that layer in its sigmas.
float used_by(sap_texel before, sap_texel child, vec2 offset, float spacing, out float off) {
  off = 0.0;
  if (!shares_children() && before.id == 0u)
    return 0.0;
  float depth_step, per_sigma = 1.0 / (sap_sigma * spacing);
  float per_sigma_mm = per_sigma / sap_footprint(before.depth);
  float kept = kept_of(before, child, offset, per_sigma_mm, depth_step, off);
  return before.id == 0u || before.id != child.id ? 0.0 : kept;
}

#endif
