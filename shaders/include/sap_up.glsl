// One texel on the way up: its own level, tent-filtered, and what the coarser level hands down. Groups are 8x8 texels,
// which share what they read: up to nine invocations need a texel of their level, up to sixteen one of the coarser.
// Include after bindings with `light`, `surface`, `coarse_surface`, `coarse_scattered` and `coarse_mass`, and after
// `near_written`, which says whether a texel of the level that is inside was written.
#ifndef DERMIS_SAP_UP_GLSL
#define DERMIS_SAP_UP_GLSL

#include "sap.glsl"

struct sap_sum {
  vec3 light;
  vec3 mass; // share of the kernel that met the surface
};

const int near_side = 10;  // 8x8 texels and a ring around them
const int coarse_side = 6; // and those of the coarser level on which they lie
shared uvec4 near_surface[near_side * near_side];
shared vec4 near_light[near_side * near_side];
shared uvec4 coarse_surface[coarse_side * coarse_side];
shared vec4 coarse_scattered[coarse_side * coarse_side];
shared vec3 coarse_mass[coarse_side * coarse_side];

// Reads what the group with first texel `first` needs, once each. Every invocation of the group calls it.
void sap_share(ivec2 first, int level, bool with_ring, bool with_coarser) {
  for (int i = int(gl_LocalInvocationIndex); i < near_side * near_side; i += 64) {
    ivec2 local = ivec2(i % near_side, i / near_side), at = first + local - 1;
    bool ring = any(equal(local, ivec2(0))) || any(equal(local, ivec2(near_side - 1)));
    bool needed = (with_ring || !ring) && sap_inside(at, level) && near_written(at);
    near_surface[i] = needed ? texelFetch(surface_image, sap_address(at, level), 0) : uvec4(0u);
    near_light[i] = near_surface[i].w != 0u ? texelFetch(light_image, sap_address(at, level), 0) : vec4(0.0);
  }
  int i = int(gl_LocalInvocationIndex);
  if (with_coarser && i < coarse_side * coarse_side) {
    ivec2 at = ((first - 1) >> 1) + ivec2(i % coarse_side, i / coarse_side);
    uvec4 bits = uvec4(0u);
    if (sap_inside(at, level + 1))
      bits = texelFetch(coarse_surface_image, sap_address(at, level + 1), 0);
    coarse_surface[i] = bits;
    if (bits.w != 0u) {
      coarse_scattered[i] = texelFetch(coarse_scattered_image, sap_address(at, level + 1), 0);
      coarse_mass[i] = texelFetch(coarse_mass_image, sap_address(at, level + 1), 0).rgb;
    }
  }
  barrier();
}

int near_index(ivec2 local) { return (local.y + 1) * near_side + local.x + 1; }
ivec2 local_texel() { return ivec2(gl_LocalInvocationID.xy); }
sap_texel sap_own() { return sap_unpack(near_surface[near_index(local_texel())]); }
vec3 sap_own_light() { return near_light[near_index(local_texel())].rgb; }

// 3x3 tent over the level's own light.
sap_sum sap_tent(int level, sap_texel own) {
  float spacing = float(1 << level);
  float per_sigma = 1.0 / (sap_sigma * spacing), per_sigma_mm = per_sigma / sap_footprint(own.depth);
  vec3 sum = vec3(0.0);
  float total = 0.0, mass = 0.0, all_weight = 0.0;
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i) {
      vec2 offset = vec2(i, j) * spacing;
      float tilt = dot(own.slope, offset) * per_sigma;
      float weight = float((2 - abs(i)) * (2 - abs(j))) * exp2(sap_factor(sap_tilt_width_tent) * tilt * tilt);
      all_weight += weight;
      int q = near_index(local_texel() + ivec2(i, j));
      sap_texel tap = sap_unpack(near_surface[q]);
      if (tap.id != own.id)
        continue;
      float off = (tap.depth - own.depth - sap_rise(own.depth, own.slope, offset)) * per_sigma_mm;
      weight *= exp2(sap_factor(sap_depth_width) * off * off) * tap.mass;
      vec4 light = near_light[q];
      mass += weight;
      total += weight * light.a;
      sum += weight * light.a * light.rgb;
    }
  return sap_sum(sum / total, vec3(mass / all_weight));
}

// Bilinear over the four nearest texels of the coarser level, along the surface. `confidence` gets the share that
// survives with weights four times as strict.
sap_sum sap_from_coarser(ivec2 at, int level, sap_texel own, vec3 fallback, out float confidence) {
  float spacing = float(1 << level);
  float per_sigma = 1.0 / (sap_sigma * spacing), per_sigma_mm = per_sigma / sap_footprint(own.depth);
  vec3 sum = vec3(0.0), mass = vec3(0.0);
  float all_weight = 0.0;
  confidence = 0.0;
  ivec2 first = (at - 1) >> 1, first_shared = (at - local_texel() - 1) >> 1;
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      ivec2 q = first + ivec2(i, j);
      vec2 offset = (vec2(2 * q) + 0.5 - vec2(at)) * spacing;
      vec2 near = mix(vec2(0.25), vec2(0.75), lessThan(abs(offset), vec2(spacing)));
      float bilinear = near.x * near.y;
      float tilt = dot(own.slope, offset) * per_sigma;
      float weight = bilinear * exp2(sap_factor(sap_tilt_width_up) * tilt * tilt);
      all_weight += weight;
      ivec2 local = q - first_shared;
      int index = local.y * coarse_side + local.x;
      sap_texel tap = sap_unpack(coarse_surface[index]);
      if (tap.id != own.id)
        continue;
      float from_own = tap.depth - own.depth - sap_rise(own.depth, own.slope, offset);
      float from_tap = own.depth - tap.depth + sap_rise(tap.depth, tap.slope, offset);
      float off = min(abs(from_own), abs(from_tap)) * per_sigma_mm;
      float kept = exp2(sap_factor(sap_depth_width) * off * off);
      vec4 light = coarse_scattered[index];
      vec3 tap_mass = weight * kept * coarse_mass[index];
      mass += tap_mass;
      sum += tap_mass * light.rgb;
      float kept_twice = kept * kept;
      confidence += bilinear * kept_twice * kept_twice * light.a;
    }
  vec3 found = vec3(greaterThan(mass, vec3(sap_negligible)));
  return sap_sum(mix(fallback, sum / max(mass, vec3(sap_negligible)), found), mass / all_weight);
}

// d per channel in pixels along the surface.
vec3 sap_d_px(sap_texel own) {
  return profiles[min(own.id, 255u)].d_mm.rgb * (own.reach / sap_footprint(own.depth));
}

// Mean of three lights weighted by mass, a convex one: it stays within them.
sap_sum sap_blend(vec3 weight_a, vec3 a, vec3 weight_b, vec3 b, sap_sum rest) {
  vec3 total = weight_a + weight_b + rest.mass;
  vec3 scale = 1.0 / max(total, vec3(sap_negligible));
  return sap_sum(rest.light + weight_a * scale * (a - rest.light) + weight_b * scale * (b - rest.light), total);
}

#endif
