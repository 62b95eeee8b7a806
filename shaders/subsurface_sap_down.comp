#version 460
// One level down: [1 3 3 1] x [1 3 3 1] over the children that lie on the parent's tangent plane. A block's four parents
// share their 6x6 children.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "subsurface_sap_down.bindings.glsl"
#include "environment.glsl"
#include "half.glsl"
const int block_width = 2, block_height = 2;
#include "sap_tiles.glsl"

const float hysteresis = 1.02;   // the first of equals stays the seed
const float nearest_share = 0.25; // a plane is not extrapolated nearer than this share of its depth

const int side = 6; // children of a block along an axis
sap_texel children[side * side];
vec4 child_light[side * side];

// Reads the children of the block whose first parent is `first`.
void read_children(texel_block block, ivec2 first, int finer) {
  [[unroll]] for (int i = 0; i < side * side; ++i) {
    ivec2 at = 2 * first - 1 + ivec2(i % side, i / side), address = finer > 0 ? at + 1 : at;
    bool needed = sap_inside(at, finer) && tile_written(block.children, (address >> 3) - 2 * block.tile + 1);
    children[i] = sap_unpack(needed ? texelFetch(surface_image, sap_address(at, finer), 0) : uvec4(0u));
    child_light[i] = needed ? texelFetch(light_image, sap_address(at, finer), 0) : vec4(0.0);
  }
}
// Of parent `parent` of the block, child 0 to 15 of its 4x4.
int child_index(int parent, int child) {
  return (2 * (parent / block_width) + child / 4) * side + 2 * (parent % block_width) + child % 4;
}

vec2 offset_of(int child, float spacing) { return (vec2(child & 3, child >> 2) - 1.5) * spacing; }
float binomial(int child) {
  return ((child & 3) % 3 == 0 ? 0.125 : 0.375) * ((child >> 2) % 3 == 0 ? 0.125 : 0.375);
}
float at_parent(sap_texel child, vec2 offset) {
  return max(child.depth - sap_rise(child.depth, child.slope, offset), nearest_share * child.depth);
}

// The child whose plane most of the four central ones support; without a central one, the weightiest outer one. Its
// depth is that of its plane at the parent; id 0: no child at all.
sap_texel find_seed(int parent, float spacing) {
  const int central[4] = int[4](5, 6, 9, 10);
  sap_texel best = sap_texel(0.0, vec2(0.0), 0.0, 0.0, 0u);
  float most = 0.0;
  [[unroll]] for (int a = 0; a < 4; ++a) {
    sap_texel seed = children[child_index(parent, central[a])];
    seed.depth = at_parent(seed, offset_of(central[a], spacing));
    float per_sigma_mm = 1.0 / (sap_sigma * spacing * sap_footprint(seed.depth));
    float support = 0.0;
    [[unroll]] for (int b = 0; b < 4; ++b) {
      sap_texel child = children[child_index(parent, central[b])];
      float depth_step = child.depth - seed.depth;
      float off = sap_nearer(depth_step - sap_rise(seed.depth, seed.slope, offset_of(central[b], spacing)), depth_step) * per_sigma_mm;
      support += child.id == seed.id ? exp2(sap_factor(sap_depth_width) * off * off) : 0.0;
    }
    if (seed.id != 0u && (best.id == 0u || support > hysteresis * most)) {
      best = seed;
      most = support;
    }
  }
  if (best.id != 0u)
    return best;
  int outer = 0;
  [[unroll]] for (int a = 0; a < 16; ++a) {
    sap_texel seed = children[child_index(parent, a)];
    float weight = seed.id != 0u ? binomial(a) * seed.mass : 0.0;
    if (weight > hysteresis * most) {
      best = seed;
      outer = a;
      most = weight;
    }
  }
  best.depth = at_parent(best, offset_of(outer, spacing));
  return best;
}

void main() {
  int level = settings.level, finer = level - 1;
  texel_block block;
  if (!listed_block(level, block))
    return;
  ivec2 first = block.first - 1;
  read_children(block, first, finer);
  float spacing = float(1 << finer);
  [[unroll]] for (int k = 0; k < block_width * block_height; ++k) {
    ivec2 at = first + ivec2(k % block_width, k / block_width);
    if (!sap_inside(at, level))
      continue;
    vec4 light = vec4(0.0);
    uvec4 bits = uvec4(0u);
    sap_texel seed = find_seed(k, spacing);
    if (seed.id != 0u) {
      float per_sigma = 1.0 / (sap_sigma * spacing), per_sigma_mm = per_sigma / sap_footprint(seed.depth);
      float all_weight = 0.0, mass = 0.0, total = 0.0, total_flat = 0.0, mean_depth = 0.0, mean_reach = 0.0;
      vec2 mean_slope = vec2(0.0);
      [[unroll]] for (int c = 0; c < 16; ++c) {
        vec2 offset = offset_of(c, spacing);
        float tilt = dot(seed.slope, offset) * per_sigma;
        all_weight += binomial(c) * exp2(sap_factor(sap_tilt_width_down) * tilt * tilt);
        sap_texel child = children[child_index(k, c)];
        float depth_step = (child.depth - seed.depth) * per_sigma_mm;
        float off = sap_nearer(depth_step - sap_rise(seed.depth, seed.slope, offset) * per_sigma_mm, depth_step);
        float along = sap_nearer(tilt, depth_step);
        float narrowing = exp2(sap_factor(sap_tilt_width_down) * along * along);
        float flat_weight = binomial(c) * exp2(sap_factor(sap_depth_width) * off * off) * child.mass;
        flat_weight = child.id == seed.id ? flat_weight : 0.0;
        vec4 tap = child_light[child_index(k, c)];
        float weight = flat_weight * narrowing * tap.a;
        mass += flat_weight * narrowing;
        total += weight;
        total_flat += flat_weight;
        light.rgb += weight * tap.rgb;
        mean_depth += flat_weight * (child.depth - sap_rise(child.depth, child.slope, offset));
        mean_slope += flat_weight * child.slope;
        mean_reach += flat_weight * child.reach;
      }
      if (total > sap_negligible) {
        light = vec4(light.rgb / total, total / mass);
        vec3 rounded = round_to_half(vec3(mean_slope / total_flat, mean_reach / total_flat));
        bits = sap_pack(sap_texel(max(mean_depth / total_flat, nearest_share * seed.depth), rounded.xy, rounded.z,
                                  round_to_half(min(mass / all_weight, 1.0)), seed.id));
      } else {
        light = vec4(0.0);
      }
    }
    imageStore(coarse_light_image, sap_address(at, level), settings.storage == STORAGE_FULL ? light : round_to_half(light));
    imageStore(coarse_surface_image, sap_address(at, level), bits);
  }
}
