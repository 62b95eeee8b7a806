// One level down: [1 3 3 1] x [1 3 3 1] over the children on the parent's tangent plane, or the
// mean of 2x2 children (SAP_BOX). Children that the first layer of a parent does not use can form a
// second layer (SAP_SECOND); both layers are children of the next level. Works on one parent at a
// time. In the block shape and for boxes its children are in `children` and `child_light`; in the
// texel shape the children of a tile are in shared memory.
// Include after bindings with `level_tiles`, and:
// - for a box: nothing else;
// - else: after bindings with `light` and `surface` and, for two layers, `second_light` and
//   `second_surface`, or, in kernels that compute several levels (SAP_WINDOW), after functions with
//   the names and arguments of is_computed() to second_finer_light().
#ifndef DERMIS_SAP_DOWN_GLSL
#define DERMIS_SAP_DOWN_GLSL

const int block_width = 2, block_height = 2;
#include "sap/sap_tiles.glsl"
#include "sap/sap_folds.glsl"

const float hysteresis = 1.02;    // keeps the first seed among equals
// minimum fraction of a plane's depth to which the plane is extrapolated
const float nearest_fraction = 0.25;
// A child with less left is no seed of the second layer, because it lies on a bend of the first
// layer's surface.
const float min_seed_part = 0.75;
// Fraction of a child's mass that counts in the second layer even if the first has used the child.
const float min_shared_mass = 0.25;

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

struct sap_parent {
  ivec2 at;   // texel of its level
  int finer;  // level of its children
  float spacing; // of the children, in pixels; geometric mean of both axes
  vec2 distances; // between the children, in pixels; 0 along an axis that the level does not halve
  // Texel shape: place of the first child in shared memory; its position if pixels are not square.
  int base;
  bool two;   // a child has two layers
  bool splits; // the parent may have two layers
};
// Block shape: always true, because all children are in registers.
bool has_second_children(sap_parent parent) { return parent.two || !texel_shape; }
const sap_texel no_texel = sap_texel(0.0, vec2(0.0), 0.0, 0.0, 0u);

// The parents of a block share children.
const int side = block_width * 2 + children_across - 2;
int shared_child(int parent, int child, int finer) {
  ivec2 step = step_from_level(finer);
  return (step.y * (parent / block_width) + child / children_across) * side +
         step.x * (parent % block_width) + child % children_across;
}
// Prepares the parent at a texel; its children are yet to be read.
sap_parent parent_at(ivec2 at, int finer) {
  vec2 distances = sap_spacings(finer) * vec2(step_from_level(finer) - 1);
  return sap_parent(at, finer, sap_spacing(finer), distances, 0, false, true);
}

// Returns whether texels of the finer level can have two layers.
#ifdef SAP_BOX
bool finer_has_layers() { return false; }
#elif !defined(SAP_WINDOW)
bool finer_has_layers() { return has_second_surface() && has_second_light(); }
#endif

#ifndef SAP_BOX
#ifndef SAP_WINDOW
// Return the surface and light of a texel of the finer level at an address in its image. `bits`:
// its surface. `computed`: the same dispatch computes the finer level.
bool is_computed(int finer) { return false; }
uvec4 finer_surface(ivec2 address, int finer, bool computed) {
  return texelFetch(surface_image, address, 0);
}
vec4 finer_light(ivec2 address, int finer, bool computed, uvec4 bits) {
  return sap_light(bits, texelFetch(light_image, address, 0), settings.storage == STORAGE_FULL);
}
#ifdef SAP_SECOND
bool finer_has_second(uvec4 bits, bool computed) {
  return sap_has_second(bits) && finer_has_layers();
}
uvec4 second_finer_surface(ivec2 address, int finer, bool computed) {
  return texelFetch(second_surface_image, address, 0);
}
vec4 second_finer_light(ivec2 address, int finer, bool computed, uvec4 bits) {
  return sap_light(bits, texelFetch(second_light_image, address, 0),
                   settings.storage == STORAGE_FULL);
}
#endif
#endif

uvec4 block_surface[side * side];
vec4 block_light[side * side];

// Children of the group's tile, in rows with the even columns first: invocations next to each other
// read words next to each other. With SAP_SECOND_IN_TILE their second layers follow.
const int tile_side = 18, tile_texels = tile_side * tile_side;
#ifdef SAP_SECOND_IN_TILE
const int tile_layers = 2;
#else
const int tile_layers = 1;
#endif
shared uvec4 tile_surface[texel_shape ? tile_layers * tile_texels : 1];
// r, g unless `storage` is full
shared uint tile_light[texel_shape ? tile_layers * tile_texels : 1];

int place_in_tile(int x, int y) { return y * tile_side + (x >> 1) + tile_side / 2 * (x & 1); }
// Return the position of texel i of the tile, row by row, and its place. Division by 18 for
// numbers below 512, because some GPUs multiply 32 bits slowly.
ivec2 in_tile(int i) {
  int y = (i & 511) * 57 >> 10;
  return ivec2(i - (y << 4) - (y << 1), y);
}
int place_of_texel(int i) {
  int x = in_tile(i).x;
  return i - x + (x >> 1) + tile_side / 2 * (x & 1);
}
int place_of_child(sap_parent parent, int c) {
  if (!square_pixels) // the first child may be in an odd column
    return place_in_tile((parent.base & 31) + (c & 3), (parent.base >> 5) + (c >> 2 & 3));
  return parent.base + (c >> 2 & 3) * tile_side + ((c & 3) >> 1) + tile_side / 2 * (c & 1);
}
ivec2 address_of_child(sap_parent parent, int c) {
  return sap_address(step_from_level(parent.finer) * parent.at - 1 + ivec2(c & 3, c >> 2 & 3),
                     parent.finer);
}

bool child_written(texel_block block, ivec2 at, int finer) {
  ivec2 address = finer > 0 ? at + 1 : at;
  ivec2 tile = (address >> 3) - step_from_level(finer) * block.tile + 1;
  bool written = tile_written(block.children, tile);
  if (!square_pixels)
    written = written && max(tile.x, tile.y) <= 2;
  return all(bvec2(sap_inside(at, finer), written));
}
// Texel shape: reads the children of all parents of the tile. An invocation first loads several
// children, so that it waits for memory once; it does not branch around children that were not
// written, but reads others instead.
void read_tile(texel_block block, int finer, bool computed) {
  const int batch = 3;
  ivec2 corner = step_from_level(finer) * (8 * block.tile - 1) - 1;
  int lane = int(gl_LocalInvocationIndex), lanes = int(group_lanes);
  // Whole rows, so that the children of an invocation are in one column.
  bool whole_rows = lanes >= tile_side;
  int step = whole_rows ? lanes - lanes % tile_side : lanes;
  [[dont_unroll]] for (int first = lane < step ? lane : tile_texels; first < tile_texels;
                       first += batch * step) {
    ivec2 start = in_tile(first);
    int start_place = place_of_texel(first), place[batch];
    ivec2 address[batch];
    bool needed[batch];
    uvec4 bits[batch];
    vec4 light[batch];
    [[unroll]] for (int k = 0; k < batch; ++k) {
      int i = first + k * step;
      ivec2 offset = whole_rows ? start + ivec2(0, k * (step / tile_side)) : in_tile(i);
      ivec2 at = corner + offset;
      place[k] = whole_rows ? start_place + k * step : place_of_texel(i);
      needed[k] = all(bvec2(i < tile_texels, child_written(block, at, finer)));
      address[k] = needed[k] ? sap_address(at, finer) : ivec2(0);
      bits[k] = finer_surface(address[k], finer, computed);
      light[k] = finer_light(address[k], finer, computed, bits[k]);
    }
    [[unroll]] for (int k = 0; k < batch; ++k) {
      if (first + k * step < tile_texels) {
        tile_surface[place[k]] = needed[k] ? bits[k] : uvec4(0u);
        tile_light[place[k]] = needed[k] ? packHalf2x16(light[k].rg) : 0u;
      }
    }
#ifdef SAP_SECOND_IN_TILE
    [[unroll]] for (int k = 0; k < batch; ++k) {
      needed[k] = all(bvec2(needed[k], finer_has_second(bits[k], computed)));
      address[k] = mix(ivec2(0), address[k], bvec2(needed[k]));
      bits[k] = second_finer_surface(address[k], finer, computed);
      light[k] = second_finer_light(address[k], finer, computed, bits[k]);
    }
    [[unroll]] for (int k = 0; k < batch; ++k) {
      if (first + k * step < tile_texels) {
        tile_surface[tile_texels + place[k]] = needed[k] ? bits[k] : uvec4(0u);
        tile_light[tile_texels + place[k]] = needed[k] ? packHalf2x16(light[k].rg) : 0u;
      }
    }
#endif
  }
  barrier();
}
// Block shape: reads the children of all parents of a block, starting at parent `first`.
void read_block(texel_block block, ivec2 first, int finer) {
  [[unroll]] for (int i = 0; i < side * side; ++i) {
    ivec2 at = step_from_level(finer) * first - 1 + ivec2(i % side, i / side);
    bool needed = child_written(block, at, finer);
    block_surface[i] = needed ? finer_surface(sap_address(at, finer), finer, false) : uvec4(0u);
    block_light[i] =
        needed ? finer_light(sap_address(at, finer), finer, false, block_surface[i]) : vec4(0.0);
  }
}
// Prepares the children of parent k of the block.
sap_parent take_parent(texel_block block, int k, int finer) {
  ivec2 offset = block_offset(k), in_tile = block.first - 8 * block.tile;
  sap_parent parent = parent_at(block.first - 1 + offset, finer);
  uint flags = 0u;
  if (texel_shape) {
    ivec2 first = step_from_level(finer) * in_tile;
    parent.base = square_pixels ? place_in_tile(first.x, first.y) : first.x | first.y << 5;
    [[unroll]] for (int c = 0; c < children_a_layer; ++c)
      flags |= tile_surface[place_of_child(parent, c)].x;
  } else {
    [[unroll]] for (int c = 0; c < children_a_layer; ++c) {
      int i = shared_child(k, c, finer);
      children[c] = sap_unpack(block_surface[i]);
      child_light[c] = block_light[i];
      flags |= block_surface[i].x;
    }
  }
  parent.two = finer_has_second(uvec4(flags), is_computed(finer));
  parent.splits = finer > 0 || sap_has_second(uvec4(flags));
  return parent;
}
#endif

// Return child c of the parent, of its second layer if `second`. The id is 0 if there is none.
sap_texel child_of(sap_parent parent, int c, bool second) {
#ifndef SAP_BOX
  if (texel_shape) {
#ifdef SAP_SECOND_IN_TILE
    return sap_unpack(tile_surface[place_of_child(parent, c) + (second ? tile_texels : 0)]);
#else
    uvec4 bits = tile_surface[place_of_child(parent, c)];
#ifdef SAP_SECOND
    if (second) {
      bool computed = is_computed(parent.finer), there = finer_has_second(bits, computed);
      ivec2 address = mix(ivec2(0), address_of_child(parent, c), bvec2(there));
      bits = second_finer_surface(address, parent.finer, computed);
      bits = mix(uvec4(0u), bits, bvec4(there));
    }
#endif
    return sap_unpack(bits);
#endif
  }
#endif
  return children[second ? children_a_layer + c : c];
}
vec4 light_of(sap_parent parent, int c, bool second, uint id) {
#ifndef SAP_BOX
  if (texel_shape) {
    vec4 light = vec4(0.0);
    int place = place_of_child(parent, c);
    ivec2 address = address_of_child(parent, c);
    bool computed = is_computed(parent.finer);
#ifdef SAP_SECOND_IN_TILE
    place += second ? tile_texels : 0;
    bool in_tile = settings.storage != STORAGE_FULL;
#else
    bool in_tile = !second && settings.storage != STORAGE_FULL;
#endif
    if (in_tile) {
      light = vec4(unpackHalf2x16(tile_light[place]),
                   unpackHalf2x16(sap_light_ba(tile_surface[place])));
    } else {
      address = mix(ivec2(0), address, bvec2(id != 0u));
#ifdef SAP_SECOND
      if (second)
        light = second_finer_light(address, parent.finer, computed,
                                   second_finer_surface(address, parent.finer, computed));
      else
#endif
        light = finer_light(address, parent.finer, computed, tile_surface[place]);
      light = mix(vec4(0.0), light, bvec4(id != 0u));
    }
    return light;
  }
#endif
  return child_light[second ? children_a_layer + c : c];
}

vec2 offset_of(sap_parent parent, int child) {
  ivec2 place = ivec2(child, child / children_across) & (children_across - 1);
  return (vec2(place) - 0.5 * float(children_across - 1)) * parent.distances;
}
// Returns the weight of a child along an axis; an axis that is not halved has one child.
float binomial(int place, bool halves) {
#ifdef SAP_BOX
  return halves ? 0.5 : float(place == 0);
#else
  return halves ? (place % 3 == 0 ? 0.125 : 0.375) : float(place == 1);
#endif
}
float binomial(sap_parent parent, int child) {
  ivec2 place = ivec2(child, child / children_across) & (children_across - 1);
  bvec2 halves = greaterThan(step_from_level(parent.finer), ivec2(1));
  return binomial(place.x, halves.x) * binomial(place.y, halves.y);
}
float at_parent(sap_texel child, vec2 offset) {
  return max(child.depth - sap_rise(child.depth, child.slope, offset),
             nearest_fraction * child.depth);
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
// Returns the fraction of a child that the layer with seed `before` has not used; 1 without such a
// layer (id 0). `off` receives the child's distance from that layer in its sigmas.
float left_of(sap_texel before, sap_texel child, vec2 offset, float spacing, out float off) {
  off = 0.0;
  if (!texel_shape && before.id == 0u)
    return 1.0;
  float depth_step, per_sigma = 1.0 / (sap_sigma * spacing);
  float per_sigma_mm = per_sigma / sap_footprint(before.depth);
  float left = 1.0 - kept_of(before, child, offset, per_sigma_mm, depth_step, off);
  return before.id == 0u || before.id != child.id ? 1.0 : left;
}
bool may_seed(sap_parent parent, sap_texel before, sap_texel child, int c) {
  float off, left = left_of(before, child, offset_of(parent, c), parent.spacing, off);
  return child.id != 0u && (square_pixels || binomial(parent, c) > 0.0) && left >= min_seed_part;
}

#include "sap/sap_seed.glsl"

// Sums over the children of a layer's profile: weight, and weight times what the parent holds.
struct holding {
  float same, held;
};
// `part`: weight of the child; `left`: its fraction that no layer has used; `off`: its distance
// from the layer, as sap_relevance() expects.
void add_holding(sap_texel child, float part, float left, float off, inout holding sum) {
  float lost = left * sap_relevance(off);
  sum.same += part;
  float held = float(sap_held(child));
  sum.held += part * (held - held * lost);
}
uint held_of(holding sum) {
  return sum.same > 0.0 ? min(uint(sum.held / sum.same + 0.5), sap_max_held) : sap_max_held;
}

// Sums over the children near the surface of a seed. Light is that of all of them, also of those on
// the layer before: both surfaces scatter into each other. Mass and plane count these less.
struct reduction {
  float all_weight, light_mass, mass, total, total_flat, mean_depth, mean_reach;
  vec2 mean_slope;
  vec3 light;
  bool remains; // a child can be the seed of another layer
  holding own, before; // of this layer and of the layer before
  float all, first; // weights of the children, of their first layers
  float area_mass;  // mass times the area of the child over its cross-section
  float rise;       // mass times the rises of the child and of the seed's plane, in sigmas
};
// A layer's seed and, for sap_relevance(), 1 / the relevant distance in sigmas.
struct sap_seed {
  sap_texel texel;
  float per_relevant;
};
// Returns the sum of the weights of children that all lie on the seed's plane. Opposite children
// have equal weights, unless the level does not halve an axis.
float full_weight(sap_parent parent, sap_texel seed) {
  float sum = 0.0;
  [[unroll]] for (int c = 0; c < (square_pixels ? children_a_layer / 2 : children_a_layer); ++c) {
    float tilt = dot(seed.slope, offset_of(parent, c)) / (sap_sigma * parent.spacing);
    float weight = (square_pixels ? 2.0 : 1.0) * binomial(parent, c);
    sum += weight * exp2(sap_factor(sap_tilt_width_down) * tilt * tilt);
  }
  return sum;
}
void add_child(sap_parent parent, sap_seed own, sap_seed before, int c, bool second,
               inout reduction sum) {
  sap_texel child = child_of(parent, c, second), seed = own.texel;
  float spacing = parent.spacing;
  float per_sigma = 1.0 / (sap_sigma * spacing),
        per_sigma_mm = per_sigma / sap_footprint(seed.depth);
  vec2 offset = offset_of(parent, c);
  float tilt = dot(seed.slope, offset) * per_sigma;
  float depth_step, off, off_before;
  float kept = kept_of(seed, child, offset, per_sigma_mm, depth_step, off);
  float along = sap_nearer(tilt, depth_step);
  float narrowing = exp2(sap_factor(sap_tilt_width_down) * along * along);
  float left = left_of(before.texel, child, offset, spacing, off_before);
  bool same = child.id == seed.id;
  float part = binomial(parent, c) * child.mass, own_part = same ? part : 0.0;
  float near_weight = own_part * kept;
  float flat_weight = near_weight * (min_shared_mass + (1.0 - min_shared_mass) * left);
  sum.remains = sum.remains || child.id != 0u && !(same && 1.0 - kept < min_seed_part);
  vec4 tap = light_of(parent, c, second, child.id);
  float weight = near_weight * narrowing * tap.a;
  sum.light_mass += near_weight * narrowing;
  sum.mass += flat_weight * narrowing;
  if (finer_has_layers()) {
    sum.area_mass += flat_weight * narrowing * sap_area_of(child.slope);
    sum.rise += flat_weight * narrowing * tilt * depth_step;
  }
  sum.total += weight;
  sum.total_flat += flat_weight;
  sum.light += weight * tap.rgb;
  sum.mean_depth += flat_weight * (child.depth - sap_rise(child.depth, child.slope, offset));
  sum.mean_slope += flat_weight * child.slope;
  sum.mean_reach += flat_weight * child.reach;
  sum.all += part;
  add_holding(child, own_part, left - left * kept, off * own.per_relevant, sum.own);
  if (before.texel.id != 0u)
    add_holding(child, child.id == before.texel.id ? part : 0.0, same ? left - left * kept : left,
                off_before * before.per_relevant, sum.before);
}
const holding no_holding = holding(0.0, 0.0);
const reduction no_children = reduction(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, vec2(0.0), vec3(0.0),
                                        false, no_holding, no_holding, 0.0, 0.0, 0.0, 0.0);
#ifdef SAP_ROW_SUMS
#include "sap/sap_row_sums.glsl"
#endif
void add_children(sap_parent parent, int layers, sap_seed seed, sap_seed before,
                  inout reduction sum) {
#ifdef SAP_ROW_SUMS
  sum = sum_rows(parent, layers, seed, before);
#else
  if (texel_shape && max_layers > 1) { // small enough for the instruction cache
    [[dont_unroll]] for (int row = 0; row < 4; ++row)
      [[unroll]] for (int column = 0; column < 4; ++column)
        add_child(parent, seed, before, 4 * row + column, false, sum);
    sum.first = sum.all;
    if (layers > 1 && parent.two)
      [[dont_unroll]] for (int row = 0; row < 4; ++row)
        [[unroll]] for (int column = 0; column < 4; ++column)
          add_child(parent, seed, before, 4 * row + column, true, sum);
  } else {
    [[unroll]] for (int c = 0; c < layers * children_a_layer; ++c) {
      add_child(parent, seed, before, c % children_a_layer, c >= children_a_layer, sum);
      if (c == children_a_layer - 1)
        sum.first = sum.all;
    }
  }
#endif
}

struct sap_layer {
  vec4 light;
  uvec4 bits;    // of the surface; 0 if nothing is left for the layer
  sap_texel seed;
  bool remains;  // a child can be the seed of another layer
  uint held_before; // held of the layer before, now that this one exists
};
const sap_layer no_layer = sap_layer(vec4(0.0), uvec4(0u), no_texel, false, 0u);
sap_seed seed_of(sap_parent parent, sap_texel texel) {
  return sap_seed(texel, sap_per_relevant(texel, parent.spacing));
}
// Returns the layer with seed `seed`, which follows the layer with seed `before` (id 0: the first
// one), from the sums over its children.
sap_layer layer_of_sums(sap_parent parent, sap_texel seed, sap_texel before, reduction sum) {
  sap_layer layer = no_layer;
  layer.seed = seed;
  sum.all_weight = full_weight(parent, seed);
  layer.remains = sum.remains;
  layer.held_before = held_of(sum.before);
  if (sum.total > sap_negligible) {
    layer.light = sap_stored(vec4(sum.light / sum.total, sum.total / sum.light_mass));
    vec3 rounded =
        round_to_half(vec3(sum.mean_slope / sum.total_flat, sum.mean_reach / sum.total_flat));
    float mass = min(sum.mass / sum.all_weight, 1.0);
    if (finer_has_layers() && parent.finer + 1 >= sap_first_area_level)
      mass = sap_mass_by_area(sum.mass, sum.area_mass, sum.rise, sum.first, sum.all_weight,
                              seed.slope, sum.mean_slope / sum.total_flat);
    sap_texel texel = sap_texel(max(sum.mean_depth / sum.total_flat, nearest_fraction * seed.depth),
                                rounded.xy, rounded.z, round_to_half(mass), seed.id);
    // Profiles without a layer.
    float of_layers = sum.own.same + (before.id != seed.id ? sum.before.same : 0.0);
    float lost = max(1.0 - of_layers / max(sum.all, sap_negligible), 0.0);
    layer.bits = sap_pack(texel, sap_pack_light(layer.light, settings.storage == STORAGE_FULL));
    layer.bits =
        sap_with_held(layer.bits, held_of(sum.own), uint(lost * float(sap_max_lost) + 0.5));
  }
  return layer;
}
// Computes the layer of the parent that has the seed `seed` and follows the layer with seed
// `before`, from `layers` layers of children.
sap_layer reduce_to(sap_parent parent, int layers, sap_texel seed, sap_texel before) {
  if (seed.id == 0u)
    return no_layer;
  reduction sum = no_children;
  add_children(parent, layers, seed_of(parent, seed), seed_of(parent, before), sum);
  return layer_of_sums(parent, seed, before, sum);
}
// Finds the seed, too.
sap_layer reduce(sap_parent parent, int layers, sap_texel before) {
  return reduce_to(parent, layers, find_seed(parent, layers, before), before);
}

#endif
