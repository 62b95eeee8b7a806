// Filtered importance sampling. Each sample represents an area that is inversely proportional to
// its density, and reads the level of a masked mip chain whose texels have that size. Light within
// the direct radius is the pixel's own light.
#ifndef DERMIS_AFIS_GLSL
#define DERMIS_AFIS_GLSL

#extension GL_EXT_samplerless_texture_functions : require

#include "common/sequence.glsl"
#include "common/tap.glsl"
#include "common/radial_draw.glsl"
#include "afis/mixture.glsl"
#include "afis/mips.glsl"
#include "options.glsl"

// Settings of subsurface.afis, under the same names.
struct afis_settings {
  float lod_bias;
  int sequence, channels, inverse, weighting, surface, direct, estimator, mips;
};

bool draws_mixture(afis_settings settings, scatter_profile profile) {
  return settings.channels == CHANNELS_MIXTURE && profile.row == no_radial_row;
}

radial_sample draw(afis_settings settings, scatter_profile profile, float survival) {
  if (draws_mixture(settings, profile))
    return mixture_sample(profile, survival);
  return radial_draw(profile, survival, settings.inverse, settings.weighting);
}

// A set of `count` of the `all` samples of a pixel in this frame, at the points of a sequence from
// index `first` on. Sets of one pixel with different values of `number` are independent.
struct sample_set {
  uint number;
  int count, all;
  uint first;
};

// Returns the offset for this pixel, frame and set in fixed point, in units of 2^-32.
uvec2 sequence_offset(int sequence, ivec2 pixel, sample_set set) {
  uint frame_index = sequence == SEQUENCE_HASHED ? frame.frame_index : 0u;
  uvec2 offset = offset_from_hash(pcg3d16(uvec3(pixel, frame_index ^ (set.number << 31))).xy);
  return sequence == SEQUENCE_STRATIFIED ? r2_point(offset, frame.frame_index) : offset;
}

// Returns sample i: x = survival divided by the survival at the direct radius, y = angle / (2 pi).
vec2 sequence_point(int sequence, uvec2 offset, sample_set set, int i) {
  if (sequence == SEQUENCE_STRATIFIED) {
    vec2 unit = unit_from_fixed(offset);
    return vec2((float(i) + unit.x) / float(set.count),
                float(i) * (golden_angle / two_pi) + unit.y);
  }
  return unit_from_fixed(
      r2_point(offset, (sequence == SEQUENCE_CONTINUED ? set.first : 0u) + uint(i)));
}

struct direct_part {
  vec3 fraction; // of the light that stays within the direct radius (1 - gamma)
  float beyond;  // survival of the sampler's density at that radius
};

// `footprints`: of the pixel's patch, as surface_patch.
direct_part direct_of(afis_settings settings, scatter_point point, scatter_profile profile,
                      float footprints) {
  if (settings.direct == DIRECT_NONE)
    return direct_part(vec3(0.0), 1.0);
  vec2 footprint = pixel_footprint(point.depth);
  float r0 = settings.direct == DIRECT_INSCRIBED ? 0.5 * min(footprint.x, footprint.y)
                                                 : 0.5 * length(footprint);
  vec3 survival = profile_survival(profile, r0);
  float beyond = draws_mixture(settings, profile) ? dot(mixture_fractions(profile), survival)
                                                  : survival[profiles[min(point.id, 255u)].widest];
  // The pixel's own light must cover exactly the radii that the sampler leaves out.
  r0 = draw(settings, profile, beyond).r;
  float patch_r0 = settings.surface == SURFACE_PATCH ? r0 * sqrt(footprints) : r0;
  return direct_part(1.0 - profile_survival(profile, patch_r0), beyond);
}

// Returns the scattered light of a pixel. `own`: its own light, and the footprints of its patch.
// The textures are the ports of subsurface.afis.
vec3 scatter(afis_settings settings, direct_part direct, sample_set set, scatter_point point,
             scatter_profile profile, vec4 own, utexture2D material, texture2D depth,
             texture2D slope, texture2D light, texture2D levels) {
  vec2 footprint = pixel_footprint(point.depth);
  // Number of pixels that a sample represents: 1 / (samples * density on the view plane). The
  // density on the plane is the density of the radius / (2 pi r).
  float pixels_per_sample = two_pi * direct.beyond / (float(set.all) * footprint.x * footprint.y);
  uvec2 offset = sequence_offset(settings.sequence, point.pixel, set);
  float each = direct.beyond / float(set.count);
  vec3 sum = vec3(0.0), total = vec3(0.0);
  for (int i = 0; i < set.count; ++i) {
    vec2 unit = sequence_point(settings.sequence, offset, set, i);
    radial_sample radial = draw(settings, profile, unit.x * direct.beyond);
    vec2 at =
        vec2(point.pixel) + radial.r * vec2(cos(unit.y * two_pi), sin(unit.y * two_pi)) / footprint;
    surface_tap tap;
    if (!find_tap(material, depth, slope, point.id, at, tap))
      continue;
    vec4 nearest = texelFetch(light, texel_of(tap.pixel), 0);
    vec3 weight = tap_weight(point, profile, tap, radial, nearest.a), seen = nearest.rgb;
    if (settings.surface == SURFACE_DISTANCE)
      weight /= nearest.a;
    if (settings.mips != MIPS_NONE) {
      float lod =
          0.5 * log2(max(pixels_per_sample * radial.r / radial.density, 1e-20)) + settings.lod_bias;
      seen = filtered_light(levels, settings.mips, at, lod, nearest.rgb);
    }
    sum += weight * seen;
    total += weight;
  }
  vec3 mass = direct.fraction + each * total;
  vec3 mean = direct.fraction * own.rgb + each * sum;
  if (settings.estimator == ESTIMATOR_SELF)
    mean = mix(own.rgb, mean / max(mass, vec3(1e-30)), greaterThan(mass, vec3(1e-30)));
  else if (settings.estimator == ESTIMATOR_CENTRED)
    mean += (1.0 - mass) * own.rgb;
  mean = max(mix(own.rgb, mean, greaterThan(profile.d.rgb, vec3(0.0))), vec3(0.0));
  return mix(mean, own.rgb, profile_direct(point.id));
}
vec3 scatter(afis_settings settings, sample_set set, scatter_point point, scatter_profile profile,
             vec4 own, utexture2D material, texture2D depth, texture2D slope, texture2D light,
             texture2D levels) {
  return scatter(settings, direct_of(settings, point, profile, own.a), set, point, profile, own,
                 material, depth, slope, light, levels);
}

#endif
