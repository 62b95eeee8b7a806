// One level down: [1 3 3 1] x [1 3 3 1] over the children on the parent's tangent plane, or the
// mean of 2x2 children (SAP_BOX). Children that the first layer of a parent does not use can form a
// second layer (SAP_SECOND); both layers are children of the next level. Works on one parent at a
// time, whose children are in `children` and `child_light`.
// Include after bindings with `light` and `surface` (except for a box), `level_tiles` and, for two
// layers, `second_light` and `second_surface`.
#ifndef DERMIS_SAP_DOWN_GLSL
#define DERMIS_SAP_DOWN_GLSL

const int block_width = 2, block_height = 2;
#include "sap/sap_tiles.glsl"

const float hysteresis = 1.02;    // keeps the first seed among equals
// minimum fraction of a plane's depth to which the plane is extrapolated
const float nearest_fraction = 0.25;
// A child with less left is no seed of the second layer, because it lies on a bend of the first
// layer's surface.
const float min_seed_part = 0.9;

#ifdef SAP_BOX
const int children_across = 2;
#else
const int children_across = 4;
#endif
#ifdef SAP_SECOND
const int max_layers = 2;
#else
const int max_layers = 1;
#endif
const int children_a_layer = children_across * children_across;
sap_texel children[max_layers * children_a_layer]; // the second layer follows the first
vec4 child_light[max_layers * children_a_layer];
// fraction that no layer of the parent has used yet
float child_left[max_layers * children_a_layer];

// The parents of a block share children.
const int side = block_width * 2 + children_across - 2;
int shared_child(int parent, int child) {
  return (2 * (parent / block_width) + child / children_across) * side + 2 * (parent % block_width) + child % children_across;
}

vec4 stored(vec4 light) { return settings.storage == STORAGE_FULL ? light : round_to_half(light); }

#ifndef SAP_BOX
uvec4 block_surface[side * side];
vec4 block_light[side * side];

bool child_written(texel_block block, ivec2 at, int finer) {
  ivec2 address = finer > 0 ? at + 1 : at;
  return sap_inside(at, finer) && tile_written(block.children, (address >> 3) - 2 * block.tile + 1);
}
// Reads the children of all parents of a block, starting at parent `first`.
void read_block(texel_block block, ivec2 first, int finer) {
  [[unroll]] for (int i = 0; i < side * side; ++i) {
    ivec2 at = 2 * first - 1 + ivec2(i % side, i / side);
    bool needed = child_written(block, at, finer);
    block_surface[i] = needed ? texelFetch(surface_image, sap_address(at, finer), 0) : uvec4(0u);
    block_light[i] = needed ? texelFetch(light_image, sap_address(at, finer), 0) : vec4(0.0);
  }
}
// Copies the children of one parent. Returns whether any of them has two layers.
bool take_children(int parent) {
  uint flags = 0u;
  [[unroll]] for (int c = 0; c < children_a_layer; ++c) {
    int i = shared_child(parent, c);
    children[c] = sap_unpack(block_surface[i]);
    child_light[c] = block_light[i];
    flags |= block_surface[i].w;
  }
  return (flags & sap_second_bit) != 0u;
}
#endif

void begin_parent(int layers) {
  [[unroll]] for (int c = 0; c < layers * children_a_layer; ++c)
    child_left[c] = 1.0;
}
bool may_seed(int child) { return children[child].id != 0u && child_left[child] >= min_seed_part; }
// Returns whether there is a seed for another layer.
bool remains(int layers) {
  bool any_seed = false;
  [[unroll]] for (int c = 0; c < layers * children_a_layer; ++c)
    any_seed = any_seed || may_seed(c);
  return any_seed;
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
  return max(child.depth - sap_rise(child.depth, child.slope, offset), nearest_fraction * child.depth);
}

struct seed_search {
  sap_texel best;
  float maximum;
  int child;
};
// Returns the central child: 0 to 3 of the first layer, 4 to 7 of the second.
int central(int i) {
#ifdef SAP_BOX
  return i;
#else
  return 16 * (i / 4) + 5 + i % 2 + 4 * (i % 4 / 2);
#endif
}
// Returns how much of the central children lies on a seed's surface.
float support_of(sap_texel seed, float spacing, int layers) {
  float per_sigma_mm = 1.0 / (sap_sigma * spacing * sap_footprint(seed.depth)), support = 0.0;
  [[unroll]] for (int b = 0; b < 4 * layers; ++b) {
    int c = central(b);
    float off = sap_off_plane(seed, children[c], offset_of(c, spacing)) * per_sigma_mm;
    support += children[c].id == seed.id && may_seed(c) ? exp2(sap_factor(sap_depth_width) * off * off) : 0.0;
  }
  return support;
}

// Returns the child whose plane has the most support among the central children; without a central
// child, the outer child with the largest weight. Its depth is the depth of its plane at the
// parent; id 0 means no child.
sap_texel find_seed(float spacing, int layers) {
  seed_search found = seed_search(sap_texel(0.0, vec2(0.0), 0.0, 0.0, 0u), 0.0, 0);
  [[unroll]] for (int a = 0; a < 4 * layers; ++a) {
    int c = central(a);
    sap_texel seed = children[c];
    seed.depth = at_parent(seed, offset_of(c, spacing));
    float support = support_of(seed, spacing, layers);
    if (may_seed(c) && (found.best.id == 0u || support > hysteresis * found.maximum)) {
      found.best = seed;
      found.maximum = support;
    }
  }
#ifndef SAP_BOX
  if (found.best.id != 0u)
    return found.best;
  [[unroll]] for (int a = 0; a < layers * children_a_layer; ++a) {
    float weight = may_seed(a) ? binomial(a) * children[a].mass : 0.0;
    if (weight > hysteresis * found.maximum) {
      found.best = children[a];
      found.child = a;
      found.maximum = weight;
    }
  }
  found.best.depth = at_parent(found.best, offset_of(found.child, spacing));
#endif
  return found.best;
}

// Sums over the children on the surface of a seed.
struct reduction {
  float all_weight, mass, total, total_flat, mean_depth, mean_reach;
  vec2 mean_slope;
  vec3 light;
};
void add_children(float spacing, sap_texel seed, int layers, inout reduction sum) {
  float per_sigma = 1.0 / (sap_sigma * spacing), per_sigma_mm = per_sigma / sap_footprint(seed.depth);
  [[unroll]] for (int c = 0; c < layers * children_a_layer; ++c) {
    vec2 offset = offset_of(c, spacing);
    float tilt = dot(seed.slope, offset) * per_sigma;
    if (c < children_a_layer)
      sum.all_weight += binomial(c) * exp2(sap_factor(sap_tilt_width_down) * tilt * tilt);
    sap_texel child = children[c];
    float depth_step = (child.depth - seed.depth) * per_sigma_mm;
    float off = sap_nearer(depth_step - sap_rise(seed.depth, seed.slope, offset) * per_sigma_mm, depth_step);
    float along = sap_nearer(tilt, depth_step);
    float narrowing = exp2(sap_factor(sap_tilt_width_down) * along * along);
    float kept = child.id == seed.id ? exp2(sap_factor(sap_depth_width) * off * off) : 0.0;
    float flat_weight = binomial(c) * kept * child.mass * child_left[c];
    child_left[c] *= 1.0 - kept;
    vec4 tap = child_light[c];
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

// Computes the next layer of the parent: light and surface. The id is 0 if nothing is left for the
// layer.
void reduce(float spacing, int layers, out vec4 light, out uvec4 bits) {
  light = vec4(0.0);
  bits = uvec4(0u);
  sap_texel seed = find_seed(spacing, layers);
  if (seed.id == 0u)
    return;
  reduction sum = reduction(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, vec2(0.0), vec3(0.0));
  add_children(spacing, seed, layers, sum);
  if (sum.total > sap_negligible) {
    light = vec4(sum.light / sum.total, sum.total / sum.mass);
    vec3 rounded = round_to_half(vec3(sum.mean_slope / sum.total_flat, sum.mean_reach / sum.total_flat));
    bits = sap_pack(sap_texel(max(sum.mean_depth / sum.total_flat, nearest_fraction * seed.depth), rounded.xy, rounded.z,
                              round_to_half(min(sum.mass / sum.all_weight, 1.0)), seed.id));
  }
}

#endif
