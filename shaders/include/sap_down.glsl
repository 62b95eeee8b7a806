// One level down: [1 3 3 1] x [1 3 3 1] over the children that lie on the parent's tangent plane, or the mean of 2x2
// of them (SAP_BOX, whose kernel reads the children). With one layer a
// block's four parents share their 6x6 children. With two layers (SAP_LAYERS) what the first layer of a parent does not take makes a second one,
// and both are children of the next level.
// Include after bindings with `light`, `surface` (but for a box) and `level_tiles`, of two layers with `second_light` and `second_surface`.
#ifndef DERMIS_SAP_DOWN_GLSL
#define DERMIS_SAP_DOWN_GLSL

const int block_width = 2, block_height = 2;
#include "sap_tiles.glsl"

const float hysteresis = 1.02;   // the first of equals stays the seed
const float nearest_share = 0.25; // a plane is not extrapolated nearer than this share of its depth

#if SAP_LAYERS > 1
const int parents_across = 1; // a parent at a time, else the kernel takes long to compile
#else
const int parents_across = 2; // that share their children along an axis
#endif
#ifdef SAP_BOX
const int children_across = 2;
#else
const int children_across = 4;
#endif
const int children_a_layer = children_across * children_across;
const int side = 2 * parents_across + children_across - 2; // texels that they share
sap_texel children[SAP_LAYERS * side * side]; // one layer behind the other
vec4 child_light[SAP_LAYERS * side * side];
const int child_count = SAP_LAYERS * children_a_layer; // of a parent
#if SAP_LAYERS > 1
// What has less left is no seed of the second layer: it lies on the first one's surface, bent.
const float least_seed_part = 0.9;
float child_left[child_count];     // what no layer of the parent at hand has taken yet
#endif

#ifndef SAP_BOX
// Reads the children of the parents from `first` on.
void read_children(texel_block block, ivec2 first, int finer) {
  [[unroll]] for (int i = 0; i < side * side; ++i) {
    ivec2 at = 2 * first - 1 + ivec2(i % side, i / side), address = finer > 0 ? at + 1 : at;
    bool needed = sap_inside(at, finer) && tile_written(block.children, (address >> 3) - 2 * block.tile + 1);
    children[i] = sap_unpack(needed ? texelFetch(surface_image, sap_address(at, finer), 0) : uvec4(0u));
    child_light[i] = needed ? texelFetch(light_image, sap_address(at, finer), 0) : vec4(0.0);
#if SAP_LAYERS > 1
    needed = needed && has_second_surface();
    children[side * side + i] = sap_unpack(needed ? texelFetch(second_surface_image, sap_address(at, finer), 0) : uvec4(0u));
    child_light[side * side + i] = needed ? texelFetch(second_light_image, sap_address(at, finer), 0) : vec4(0.0);
#endif
  }
}
#endif
// Of parent `parent` of those, child 0 to 15 of its 4x4, 16 to 31 of the second layer; of a box 0 to 3.
int child_index(int parent, int child) {
  int place = child % children_a_layer;
  return child / children_a_layer * side * side + (2 * (parent / parents_across) + place / children_across) * side +
         2 * (parent % parents_across) + place % children_across;
}
bool may_seed(int parent, int child) {
#if SAP_LAYERS > 1
  if (child_left[child] < least_seed_part)
    return false;
#endif
  return children[child_index(parent, child)].id != 0u;
}

vec2 offset_of(int child, float spacing) {
  int place = child % children_a_layer;
  return (vec2(place % children_across, place / children_across) - 0.5 * float(children_across - 1)) * spacing;
}
float binomial(int child) {
#ifdef SAP_BOX
  return 0.25;
#else
  return ((child & 3) % 3 == 0 ? 0.125 : 0.375) * ((child >> 2 & 3) % 3 == 0 ? 0.125 : 0.375);
#endif
}
float at_parent(sap_texel child, vec2 offset) {
  return max(child.depth - sap_rise(child.depth, child.slope, offset), nearest_share * child.depth);
}

struct seed_search {
  sap_texel best;
  float most;
  int child;
};
// Central child 0 to 3, of a layer.
int central(int i, int layer) {
#ifdef SAP_BOX
  return i;
#else
  return 16 * layer + 5 + i % 2 + 4 * (i / 2);
#endif
}
// How much the central children of a layer lie on a seed's surface.
float support_of(int parent, sap_texel seed, float spacing, int layer) {
  float per_sigma_mm = 1.0 / (sap_sigma * spacing * sap_footprint(seed.depth)), support = 0.0;
  [[unroll]] for (int b = 0; b < 4; ++b) {
    int c = central(b, layer);
    sap_texel child = children[child_index(parent, c)];
    float off = sap_off_plane(seed, child, offset_of(c, spacing)) * per_sigma_mm;
    support += child.id == seed.id && may_seed(parent, c) ? exp2(sap_factor(sap_depth_width) * off * off) : 0.0;
  }
  return support;
}
void search_central(int parent, float spacing, int layer, inout seed_search found) {
  [[unroll]] for (int a = 0; a < 4; ++a) {
    int c = central(a, layer);
    sap_texel seed = children[child_index(parent, c)];
    seed.depth = at_parent(seed, offset_of(c, spacing));
    float support = support_of(parent, seed, spacing, 0);
#if SAP_LAYERS > 1
    support += support_of(parent, seed, spacing, 1);
#endif
    if (may_seed(parent, c) && (found.best.id == 0u || support > hysteresis * found.most)) {
      found.best = seed;
      found.most = support;
    }
  }
}
#ifndef SAP_BOX
void search_outer(int parent, int layer, inout seed_search found) {
  [[unroll]] for (int a = 16 * layer; a < 16 * layer + 16; ++a) {
    sap_texel seed = children[child_index(parent, a)];
    float weight = may_seed(parent, a) ? binomial(a) * seed.mass : 0.0;
    if (weight > hysteresis * found.most) {
      found.best = seed;
      found.child = a;
      found.most = weight;
    }
  }
}
#endif

// The child whose plane most of the central ones support; without a central one, the weightiest outer one. Its
// depth is that of its plane at the parent; id 0: no child at all.
sap_texel find_seed(int parent, float spacing) {
  seed_search found = seed_search(sap_texel(0.0, vec2(0.0), 0.0, 0.0, 0u), 0.0, 0);
  search_central(parent, spacing, 0, found);
#if SAP_LAYERS > 1
  search_central(parent, spacing, 1, found);
#endif
#ifndef SAP_BOX
  if (found.best.id != 0u)
    return found.best;
  search_outer(parent, 0, found);
#if SAP_LAYERS > 1
  search_outer(parent, 1, found);
#endif
  found.best.depth = at_parent(found.best, offset_of(found.child, spacing));
#endif
  return found.best;
}

// Sums over the children that lie on the surface of a seed.
struct reduction {
  float all_weight, mass, total, total_flat, mean_depth, mean_reach;
  vec2 mean_slope;
  vec3 light;
};
void add_children(int k, float spacing, sap_texel seed, int layer, inout reduction sum) {
  float per_sigma = 1.0 / (sap_sigma * spacing), per_sigma_mm = per_sigma / sap_footprint(seed.depth);
  [[unroll]] for (int c = children_a_layer * layer; c < children_a_layer * (layer + 1); ++c) {
    vec2 offset = offset_of(c, spacing);
    float tilt = dot(seed.slope, offset) * per_sigma;
    if (layer == 0)
      sum.all_weight += binomial(c) * exp2(sap_factor(sap_tilt_width_down) * tilt * tilt);
    sap_texel child = children[child_index(k, c)];
    float depth_step = (child.depth - seed.depth) * per_sigma_mm;
    float off = sap_nearer(depth_step - sap_rise(seed.depth, seed.slope, offset) * per_sigma_mm, depth_step);
    float along = sap_nearer(tilt, depth_step);
    float narrowing = exp2(sap_factor(sap_tilt_width_down) * along * along);
    float kept = child.id == seed.id ? exp2(sap_factor(sap_depth_width) * off * off) : 0.0;
    float flat_weight = binomial(c) * kept * child.mass;
#if SAP_LAYERS > 1
    flat_weight *= child_left[c];
    child_left[c] *= 1.0 - kept;
#endif
    vec4 tap = child_light[child_index(k, c)];
    float weight = flat_weight * narrowing * tap.a;
    sum.mass += flat_weight * narrowing;
    sum.total += weight;
    sum.total_flat += flat_weight;
    sum.light += weight * tap.rgb;
    sum.mean_depth += flat_weight * (child.depth - sap_rise(child.depth, child.slope, offset));
    sum.mean_slope += flat_weight * child.slope;
    sum.mean_reach += flat_weight * child.reach;
  }
}

// One layer of a parent: light, and surface with id 0 where nothing is left for it.
void reduce(int k, float spacing, out vec4 light, out uvec4 bits) {
  light = vec4(0.0);
  bits = uvec4(0u);
  sap_texel seed = find_seed(k, spacing);
  if (seed.id == 0u)
    return;
  reduction sum = reduction(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, vec2(0.0), vec3(0.0));
  add_children(k, spacing, seed, 0, sum);
#if SAP_LAYERS > 1
  add_children(k, spacing, seed, 1, sum);
#endif
  if (sum.total > sap_negligible) {
    light = vec4(sum.light / sum.total, sum.total / sum.mass);
    vec3 rounded = round_to_half(vec3(sum.mean_slope / sum.total_flat, sum.mean_reach / sum.total_flat));
    bits = sap_pack(sap_texel(max(sum.mean_depth / sum.total_flat, nearest_share * seed.depth), rounded.xy, rounded.z,
                              round_to_half(min(sum.mass / sum.all_weight, 1.0)), seed.id));
  }
}

#endif
