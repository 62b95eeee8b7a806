// Importance samples of the surface around a pixel, read from the pyramid's own levels. A sample
// represents an area and reads the texel of that size under it, if that texel lies on the surface
// that the sample hit.
#ifndef DERMIS_SAP_SAMPLES_GLSL
#define DERMIS_SAP_SAMPLES_GLSL

#extension GL_EXT_samplerless_texture_functions : require

#include "common/constants_math.glsl"
#include "common/profile.glsl"
#include "sap/sap.glsl"
#include "common/sequence.glsl"
#include "common/tap.glsl"

// 16 samples at a d of 20 px reach this level within 3 d.
const int last_sample_level = 5;
// Maximum distance of a texel from the sample's tangent plane, in sigmas of the level.
const float on_surface = 2.0;

// Maximum odds of 16 samples against the pyramid's light. Confidence does not say by how much the
// pyramid is wrong, and on folds under fine patterns of light samples are as noisy.
const float max_sample_odds = 0.15;
// Returns the weight of the mean of `count` samples in a blend with the pyramid's light, from the
// variances of both: the pyramid's is taken as proportional to the confidence that it lacks, that
// of the samples as inverse to their number. `ratio`: odds of 16 samples at a confidence of 0.
float sample_fraction(float confidence, float count, float ratio) {
  float odds = min(ratio * max(1.0 - confidence, 0.0), max_sample_odds) * count / 16.0;
  return odds / (1.0 + odds);
}

// The kernel that includes this file defines the next three functions.
// Return the surface and light of a texel of levels 1 to 5 at an address.
uvec4 level_surface(int level, ivec2 address);
vec4 level_light(int level, ivec2 address);
// Returns whether level 0 has a pixel of the view.
bool near_written(ivec2 pixel);

// Read a texel of levels 1 to 5, one image each.
uvec4 fetch_level(utexture2D level_1, utexture2D level_2, utexture2D level_3, utexture2D level_4,
                  utexture2D level_5, int level, ivec2 address) {
  switch (level) {
  case 1: return texelFetch(level_1, address, 0);
  case 2: return texelFetch(level_2, address, 0);
  case 3: return texelFetch(level_3, address, 0);
  case 4: return texelFetch(level_4, address, 0);
  default: return texelFetch(level_5, address, 0);
  }
}
vec4 fetch_level(texture2D level_1, texture2D level_2, texture2D level_3, texture2D level_4,
                 texture2D level_5, int level, ivec2 address) {
  switch (level) {
  case 1: return texelFetch(level_1, address, 0);
  case 2: return texelFetch(level_2, address, 0);
  case 3: return texelFetch(level_3, address, 0);
  case 4: return texelFetch(level_4, address, 0);
  default: return texelFetch(level_5, address, 0);
  }
}
// Returns the light of a pixel from level 0.
vec3 pixel_light_of_level_0(utexture2D surface, texture2D light, ivec2 texel) {
  return sap_light(texelFetch(surface, texel, 0), texelFetch(light, texel, 0)).rgb;
}

// Returns the area of a pixel's patch from the slope in level 0, divided by that of the pixel's
// footprint: surface_patch.footprints. `ray_length`: of the pixel's ray; times it, the result is
// surface_patch.area.
float sap_footprints(sap_texel t, vec2 pixel, out float ray_length) {
  vec2 rise = t.slope * sap_footprint(t.depth); // mm per pixel
  float zoom = is_perspective() ? t.depth : 1.0;
  vec3 ray =
      mix(vec3(0.0, 0.0, -1.0), view_position(pixel, t.depth) / t.depth, bvec3(is_perspective()));
  vec3 along_x = rise.x * ray + vec3(frame.ray_scale.x * zoom, 0.0, 0.0);
  vec3 along_y = rise.y * ray + vec3(0.0, frame.ray_scale.y * zoom, 0.0);
  float cross_section = abs(frame.ray_scale.x * frame.ray_scale.y) * zoom * zoom;
  ray_length = length(ray);
  return clamp(length(cross(along_x, along_y)) * ray_length / cross_section, 1.0,
               1.0 / min_patch_cosine) /
         ray_length;
}

// Returns the factor on d of the pixel's scatter_scale, from its reach.
float sap_scale(sap_texel t, float area) { return t.reach * sqrt(sqrt(sqrt(area))); }

// Returns the light around the sample's pixel at a level of detail.
vec3 sample_light(utexture2D surface, texture2D light, ivec2 q, vec2 at, sap_texel tap,
                  float lod) {
  // A texel of the first levels has 2^level pixels where pixels are not square.
  lod = lod > 0.0 ? min(2.0 * lod, lod + 0.5 * float(pixel_doublings)) : lod;
  int level = min(int(lod + 0.5), last_sample_level);
  if (level > 0) {
    ivec2 texel = ivec2(floor((at + 0.5) / sap_spacings(level)));
    if (sap_inside(texel, level)) {
      ivec2 address = sap_address(texel, level);
      uvec4 bits = level_surface(level, address);
      sap_texel mean = sap_unpack(bits);
      vec2 offset = (vec2(texel) + 0.5) * sap_spacings(level) - 0.5 - vec2(q);
      float off = abs(mean.depth - tap.depth - sap_rise(tap.depth, tap.slope, offset));
      if (mean.id == tap.id &&
          off < on_surface * sap_sigma * sap_spacing(level) * sap_footprint(tap.depth))
        return sap_light(bits, level_light(level, address)).rgb;
    }
  }
  return pixel_light_of_level_0(surface, light, texel_of(q));
}

// Returns the self-normalised mean of `count` samples. Light within the direct radius is the
// pixel's own light. Radii are stratified and angles are multiples of the golden angle; `offset`
// shifts both, in units of 2^-32. `surface`, `light`: images of level 0. `own_light`: of the pixel.
// `mass`: estimated part of the kernel that lies on the surface, with which the mean is normalised.
vec3 sap_sampled_light(utexture2D surface, texture2D light, ivec2 pixel, sap_texel own,
                       vec3 own_light, uvec2 offset, int count, float lod_bias, out vec3 mass) {
  float ray_length;
  float footprints = sap_footprints(own, vec2(pixel), ray_length);
  scatter_profile profile = find_profile(own.id, sap_scale(own, footprints * ray_length));
  uint widest = profiles[min(own.id, 255u)].widest;
  vec2 footprint = pixel_footprint(own.depth);
  vec3 position = view_position(vec2(pixel), own.depth);

  float r0 = 0.5 * min(footprint.x, footprint.y);
  float beyond = profile_survival(profile, r0)[widest];
  // The pixel's own light must cover exactly the radii that the sampler leaves out.
  r0 = profile_sample(profile, beyond).r;
  vec3 direct = 1.0 - profile_survival(profile, r0 * sqrt(footprints));

  float pixels_per_sample = two_pi * beyond / (float(count) * footprint.x * footprint.y);
  float each = beyond / float(count);
  vec2 shift = unit_from_fixed(offset);
  vec3 sum = direct * own_light;
  mass = direct;
  for (int i = 0; i < count; ++i) {
    radial_sample radial = profile_sample(profile, (float(i) + shift.x) / float(count) * beyond);
    float angle = float(i) * golden_angle + shift.y * two_pi;
    vec2 at = vec2(pixel) + radial.r * vec2(cos(angle), sin(angle)) / footprint;
    ivec2 q = ivec2(round(clamp(at, vec2(-1.0), vec2(frame.rect.zw))));
    if (!inside_rect(q) || !near_written(q))
      continue;
    sap_texel tap = sap_unpack(texelFetch(surface, texel_of(q), 0));
    if (tap.id != own.id)
      continue;
    // Uses the sample's own point on the patch, not the patch's centre, because the reference
    // averages over the patch.
    float depth = tap.depth + sap_rise(tap.depth, tap.slope, at - vec2(q));
    float zoom = is_perspective() ? tap.depth / own.depth : 1.0;
    float distance_3d = tap_distance(length(view_position(at, depth) - position), radial.r, zoom);
    float tap_ray;
    vec3 weight =
        profile_falloff(profile, distance_3d) *
        (each * radial.r / radial.density * sap_footprints(tap, vec2(q), tap_ray) * zoom * zoom);
    float lod = 0.5 * log2(max(pixels_per_sample * radial.r / radial.density, 1e-20)) + lod_bias;
    sum += weight * sample_light(surface, light, q, at, tap, lod);
    mass += weight;
  }
  vec3 mean = mix(own_light, sum / max(mass, vec3(1e-30)), greaterThan(mass, vec3(1e-30)));
  mean = mix(own_light, mean, greaterThan(profile.d.rgb, vec3(0.0)));
  return mix(mean, own_light, profile_direct(own.id));
}

// The same, for callers that need no mass.
vec3 sap_sampled_light(utexture2D surface, texture2D light, ivec2 pixel, sap_texel own,
                       vec3 own_light, uvec2 offset, int count, float lod_bias) {
  vec3 mass;
  return sap_sampled_light(surface, light, pixel, own, own_light, offset, count, lod_bias, mass);
}

#endif
