// One texel on the way up: its own level, tent-filtered, and what the coarser level hands down. Include after
// bindings with `light`, `surface`, `coarse_surface`, `coarse_scattered` and `coarse_mass`.
#ifndef DERMIS_SAP_UP_GLSL
#define DERMIS_SAP_UP_GLSL

#include "sap.glsl"

struct sap_sum {
  vec3 light;
  vec3 mass; // share of the kernel that met the surface
};

// 3x3 tent over the level's own light.
sap_sum sap_tent(ivec2 at, int level, sap_texel own) {
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
      ivec2 q = at + ivec2(i, j);
      if (!sap_inside(q, level))
        continue;
      sap_texel tap = sap_unpack(texelFetch(surface_image, sap_address(q, level), 0));
      if (tap.id != own.id)
        continue;
      float off = (tap.depth - own.depth - sap_rise(own.depth, own.slope, offset)) * per_sigma_mm;
      weight *= exp2(sap_factor(sap_depth_width) * off * off) * tap.mass;
      vec4 light = texelFetch(light_image, sap_address(q, level), 0);
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
  ivec2 first = (at - 1) >> 1;
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      ivec2 q = first + ivec2(i, j);
      vec2 offset = (vec2(2 * q) + 0.5 - vec2(at)) * spacing;
      vec2 near = mix(vec2(0.25), vec2(0.75), lessThan(abs(offset), vec2(spacing)));
      float bilinear = near.x * near.y;
      float tilt = dot(own.slope, offset) * per_sigma;
      float weight = bilinear * exp2(sap_factor(sap_tilt_width_up) * tilt * tilt);
      all_weight += weight;
      if (!sap_inside(q, level + 1))
        continue;
      ivec2 address = sap_address(q, level + 1);
      sap_texel tap = sap_unpack(texelFetch(coarse_surface_image, address, 0));
      if (tap.id != own.id)
        continue;
      float from_own = tap.depth - own.depth - sap_rise(own.depth, own.slope, offset);
      float from_tap = own.depth - tap.depth + sap_rise(tap.depth, tap.slope, offset);
      float off = min(abs(from_own), abs(from_tap)) * per_sigma_mm;
      float kept = exp2(sap_factor(sap_depth_width) * off * off);
      vec4 light = texelFetch(coarse_scattered_image, address, 0);
      vec3 tap_mass = weight * kept * texelFetch(coarse_mass_image, address, 0).rgb;
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
