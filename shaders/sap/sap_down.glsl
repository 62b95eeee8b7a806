// One level down: [1 3 3 1] x [1 3 3 1] over the children on the parent's tangent plane, or the
// mean of 2x2 children. Children that the first layer of a parent does not use can form a second
// layer; both layers are children of the next level. Works on one parent at a time.
#ifndef DERMIS_SAP_DOWN_GLSL
#define DERMIS_SAP_DOWN_GLSL

#include "sap/sap_folds.glsl"
#include "sap/sap_seed.glsl"
#include "sap/sap_storage.glsl"

// Fraction of a child that counts in the second layer even if the first has used the child.
const float min_shared = 0.25;
// Returns the additional fraction of mass of a child that is parallel to the seed, because the two
// are then separate surfaces. A child on a bend gets none. bend: difference of their slopes.
float parallel_share(vec2 bend) {
  return clamp(1.0 - min_shared - abs(bend.x) - abs(bend.y), 0.0, 1.0);
}

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
// the layer before: both surfaces scatter into each other. The plane counts these less, and so does
// mass unless they are parallel.
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
  const int count = square_pixels ? children_a_layer() / 2 : children_a_layer();
  [[unroll]] for (int c = 0; c < count; ++c) {
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
  float used = used_by(before.texel, child, offset, spacing, off_before), left = 1.0 - used;
  bool same = child.id == seed.id;
  float part = binomial(parent, c) * child.mass, own_part = same ? part : 0.0;
  float near_weight = own_part * kept;
  float used_weight = near_weight * used;
  float flat_weight = near_weight - (1.0 - min_shared) * used_weight;
  float mass = flat_weight + used_weight * parallel_share(child.slope - seed.slope);
  sum.remains = sum.remains || child.id != 0u && !(same && kept > max_used_part);
  vec4 tap = light_of(parent, c, second, child.id);
  float weight = near_weight * narrowing * tap.a;
  sum.light_mass += near_weight * narrowing;
  sum.mass += mass * narrowing;
  if (finer_has_layers()) {
    sum.area_mass += mass * narrowing * sap_area_of(child.slope);
    sum.rise += mass * narrowing * tilt * depth_step;
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

// Returns the sums over `layers` layers of children. sap_ordered_sums.glsl and sap_row_sums.glsl
// define the function; the kernel includes one of them.
reduction sum_children(sap_parent parent, int layers, sap_seed seed, sap_seed before);

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
    if (finer_has_layers() && (square_pixels || parent.spacing >= sap_first_area_spacing))
      mass = sap_mass_by_area(sum.mass, sum.area_mass, sum.rise, sum.first, sum.all_weight,
                              seed.slope, sum.mean_slope / sum.total_flat);
    sap_texel texel = sap_texel(max(sum.mean_depth / sum.total_flat, nearest_fraction * seed.depth),
                                rounded.xy, rounded.z, round_to_half(mass), seed.id);
    // Profiles without a layer.
    float of_layers = sum.own.same + (before.id != seed.id ? sum.before.same : 0.0);
    float lost = max(1.0 - of_layers / max(sum.all, sap_negligible), 0.0);
    layer.bits = sap_pack(texel, sap_pack_light(layer.light, stores_full()));
    layer.bits =
        sap_with_held(layer.bits, held_of(sum.own), uint(lost * float(sap_max_lost) + 0.5));
  }
  return layer;
}
// Computes the layer of the parent that follows the layer with seed `before`, from `layers` layers
// of children.
sap_layer reduce(sap_parent parent, int layers, sap_texel before) {
  sap_texel seed = find_seed(parent, layers, before);
  if (seed.id == 0u)
    return no_layer;
  reduction sum = sum_children(parent, layers, seed_of(parent, seed), seed_of(parent, before));
  return layer_of_sums(parent, seed, before, sum);
}

#endif
