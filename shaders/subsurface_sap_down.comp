#version 460
// One level down: [1 3 3 1] x [1 3 3 1] over the children that lie on the parent's tangent plane. A group's 8x8 parents
// share their 18x18 children.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "subsurface_sap_down.bindings.glsl"
#include "environment.glsl"
#include "half.glsl"
#include "sap.glsl"
#include "tile_packing.glsl"

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;

const float hysteresis = 1.02;   // the first of equals stays the seed
const float nearest_share = 0.25; // a plane is not extrapolated nearer than this share of its depth

const int shared_side = 18;
shared uvec4 shared_surface[shared_side * shared_side];
shared vec4 shared_light[shared_side * shared_side];

// Reads the children of the group whose first parent is `first`, once each. Every invocation of the group calls it.
void share_children(ivec2 first, int finer) {
  for (int i = int(gl_LocalInvocationIndex); i < shared_side * shared_side; i += 64) {
    ivec2 q = 2 * first - 1 + ivec2(i % shared_side, i / shared_side);
    bool written = sap_inside(q, finer) && (!has_classes() || classes_data[sap_tile(q)] != class_none);
    shared_surface[i] = written ? texelFetch(surface_image, sap_address(q, finer), 0) : uvec4(0u);
    shared_light[i] = shared_surface[i].w != 0u ? texelFetch(light_image, sap_address(q, finer), 0) : vec4(0.0);
  }
  barrier();
}
int shared_index(int child) {
  ivec2 local = 2 * ivec2(gl_LocalInvocationID.xy) + ivec2(child & 3, child >> 2);
  return local.y * shared_side + local.x;
}

// Whether the group whose first parent is `first` can have children at all: they lie in 3x3 tiles of level 0. The same
// for the whole group.
bool has_listed_children(ivec2 first) {
  for (int i = 0; i < 9; ++i) {
    ivec2 tile = ((2 * first - 1) >> 3) + ivec2(i % 3, i / 3);
    if (all(greaterThanEqual(tile, ivec2(0))) && all(lessThan(tile, frame.tiles)) &&
        classes_data[tile.y * frame.tiles.x + tile.x] != class_none)
      return true;
  }
  return false;
}

sap_texel children[16];

vec2 offset_of(int child, float spacing) { return (vec2(child & 3, child >> 2) - 1.5) * spacing; }
float binomial(int child) {
  return ((child & 3) % 3 == 0 ? 0.125 : 0.375) * ((child >> 2) % 3 == 0 ? 0.125 : 0.375);
}
float at_parent(sap_texel child, vec2 offset) {
  return max(child.depth - sap_rise(child.depth, child.slope, offset), nearest_share * child.depth);
}

// The child whose plane most of the four central ones support; without a central one, the weightiest outer one.
// -1: no child at all.
int find_seed(float spacing) {
  const int central[4] = int[4](5, 6, 9, 10);
  int best = -1;
  float most = 0.0;
  for (int a = 0; a < 4; ++a) {
    sap_texel seed = children[central[a]];
    if (seed.id == 0u)
      continue;
    float depth = at_parent(seed, offset_of(central[a], spacing));
    float per_sigma_mm = 1.0 / (sap_sigma * spacing * sap_footprint(depth));
    float support = 0.0;
    for (int b = 0; b < 4; ++b) {
      sap_texel child = children[central[b]];
      float off = (child.depth - depth - sap_rise(depth, seed.slope, offset_of(central[b], spacing))) * per_sigma_mm;
      support += child.id == seed.id ? exp2(sap_factor(sap_depth_width) * off * off) : 0.0;
    }
    if (best < 0 || support > hysteresis * most) {
      best = central[a];
      most = support;
    }
  }
  if (best >= 0)
    return best;
  for (int a = 0; a < 16; ++a) {
    float weight = children[a].id != 0u ? binomial(a) * children[a].mass : 0.0;
    if (weight > hysteresis * most) {
      best = a;
      most = weight;
    }
  }
  return best;
}

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy) - 1;
  int level = settings.level, finer = level - 1;
  ivec2 first = at - ivec2(gl_LocalInvocationID.xy);
  bool empty = has_classes() && !has_listed_children(first);
  if (!empty)
    share_children(first, finer);
  if (!sap_inside(at, level))
    return;
  if (empty) {
    imageStore(coarse_light_image, sap_address(at, level), vec4(0.0));
    imageStore(coarse_surface_image, sap_address(at, level), uvec4(0u));
    return;
  }
  for (int k = 0; k < 16; ++k)
    children[k] = sap_unpack(shared_surface[shared_index(k)]);
  float spacing = float(1 << finer);
  vec4 light = vec4(0.0);
  uvec4 bits = uvec4(0u);
  int seed = find_seed(spacing);
  if (seed >= 0) {
    uint id = children[seed].id;
    vec2 slope = children[seed].slope;
    float depth = at_parent(children[seed], offset_of(seed, spacing));
    float per_sigma = 1.0 / (sap_sigma * spacing), per_sigma_mm = per_sigma / sap_footprint(depth);
    float all_weight = 0.0, mass = 0.0, total = 0.0, total_flat = 0.0, mean_depth = 0.0, mean_reach = 0.0;
    vec2 mean_slope = vec2(0.0);
    for (int k = 0; k < 16; ++k) {
      vec2 offset = offset_of(k, spacing);
      float tilt = dot(slope, offset) * per_sigma;
      float narrowing = exp2(sap_factor(sap_tilt_width_down) * tilt * tilt);
      all_weight += binomial(k) * narrowing;
      sap_texel child = children[k];
      if (child.id != id)
        continue;
      float off = (child.depth - depth - sap_rise(depth, slope, offset)) * per_sigma_mm;
      float flat_weight = binomial(k) * exp2(sap_factor(sap_depth_width) * off * off) * child.mass;
      vec4 tap = shared_light[shared_index(k)];
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
      bits = sap_pack(sap_texel(max(mean_depth / total_flat, nearest_share * depth), rounded.xy, rounded.z,
                                round_to_half(mass / all_weight), id));
    }
  }
  imageStore(coarse_light_image, sap_address(at, level), round_to_half(light));
  imageStore(coarse_surface_image, sap_address(at, level), bits);
}
