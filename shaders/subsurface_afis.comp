#version 460
// Filtered importance sampling: each sample stands for the area that its density leaves to it and reads the level of a
// masked chain that has texels of that size. What lies within the direct radius is the pixel's own light.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "subsurface_afis.bindings.glsl"
#include "environment.glsl"
#include "tiles.glsl"
#include "radius.glsl"
#include "half.glsl"
#include "sequence.glsl"
#include "tap.glsl"
#include "radial_draw.glsl"
#include "mixture.glsl"
#include "mips.glsl"

bool draws_mixture(scatter_profile profile) {
  return settings.channels == CHANNELS_MIXTURE && profile.row == no_radial_row;
}

radial_sample draw(scatter_profile profile, float survival) {
  return draws_mixture(profile) ? mixture_sample(profile, survival) : radial_draw(profile, survival);
}

// Offset of this pixel and frame, over 2^32.
uvec2 sequence_offset(ivec2 pixel) {
  uint frame_index = settings.sequence == SEQUENCE_HASHED ? frame.frame_index : 0u;
  uvec2 offset = offset_from_hash(pcg3d16(uvec3(pixel, frame_index)).xy);
  return settings.sequence == SEQUENCE_STRATIFIED ? r2_point(offset, frame.frame_index) : offset;
}

// Sample i: x = survival over that at the direct radius, y = angle over 2 pi.
vec2 sequence_point(uvec2 offset, int i) {
  if (settings.sequence == SEQUENCE_STRATIFIED) {
    vec2 unit = unit_from_fixed(offset);
    return vec2((float(i) + unit.x) / float(settings.samples), float(i) * (golden_angle / two_pi) + unit.y);
  }
  uint first = settings.sequence == SEQUENCE_CONTINUED ? frame.frame_index * uint(settings.samples) : 0u;
  return unit_from_fixed(r2_point(offset, first + uint(i)));
}

vec3 scatter(scatter_point point, scatter_profile profile, float area, vec3 own) {
  vec2 footprint = pixel_footprint(point.depth);
  uint widest = profiles[min(point.id, 255u)].widest;

  vec3 direct = vec3(0.0);
  float beyond = 1.0;
  if (settings.direct != DIRECT_NONE) {
    float r0 = settings.direct == DIRECT_INSCRIBED ? 0.5 * min(footprint.x, footprint.y) : 0.5 * length(footprint);
    vec3 survival = profile_survival(profile, r0);
    beyond = draws_mixture(profile) ? dot(mixture_shares(profile), survival) : survival[widest];
    r0 = draw(profile, beyond).r; // what the sampler leaves out is what is taken from the pixel's own light
    direct = 1.0 - profile_survival(profile, settings.surface == SURFACE_PATCH ? r0 * sqrt(area) : r0);
  }
  // Pixels that a sample stands for: 1 / (samples * density on the view plane), that of the radius / (2 pi r).
  float pixels_per_sample = two_pi * beyond / (float(settings.samples) * footprint.x * footprint.y);
  uvec2 offset = sequence_offset(point.pixel);
  float each = beyond / float(settings.samples);
  vec3 sum = vec3(0.0), total = vec3(0.0);
  for (int i = 0; i < settings.samples; ++i) {
    vec2 unit = sequence_point(offset, i);
    radial_sample drawn = draw(profile, unit.x * beyond);
    vec2 at = vec2(point.pixel) + drawn.r * vec2(cos(unit.y * two_pi), sin(unit.y * two_pi)) / footprint;
    vec3 weight;
    vec4 light;
    if (!take_tap(point, profile, at, drawn, weight, light))
      continue;
    if (settings.surface == SURFACE_DISTANCE)
      weight /= light.a;
    if (settings.mips != MIPS_NONE) {
      float lod = 0.5 * log2(max(pixels_per_sample * drawn.r / drawn.density, 1e-20)) + settings.lod_bias;
      if (lod > 0.0)
        light.rgb = filtered_light(at, lod, light.rgb);
    }
    sum += weight * light.rgb;
    total += weight;
  }
  vec3 mass = direct + each * total, mean = direct * own + each * sum;
  if (settings.estimator == ESTIMATOR_SELF)
    mean = mix(own, mean / max(mass, vec3(1e-30)), greaterThan(mass, vec3(1e-30)));
  else if (settings.estimator == ESTIMATOR_CENTRED)
    mean += (1.0 - mass) * own;
  mean = max(mix(own, mean, greaterThan(profile.d.rgb, vec3(0.0))), vec3(0.0));
  return mix(mean, own, profile_direct(point.id));
}

void main() {
  ivec2 pixel;
  bool copy_only;
  if (!listed_pixel(pixel, copy_only))
    return;
  ivec2 texel = texel_of(pixel);
  uint id = texelFetch(material_image, texel, 0).r;
  if (id == 0u)
    return;
  vec4 light = texelFetch(light_image, texel, 0);
  float depth = view_depth(texelFetch(depth_image, texel, 0).r);
  if (!copy_only && depth > 0.0) {
    float scale = has_scatter_scale() ? clean_scatter_scale(texelFetch(scatter_scale_image, texel, 0).r) : 1.0;
    scatter_profile profile = find_profile(id, scale);
    if (projected_d(profile.d.w, depth) >= copy_below_d_px)
      light.rgb = scatter(scatter_point(pixel, id, depth, view_position(vec2(pixel), depth)), profile, light.a, light.rgb);
  }
  imageStore(scattered_image, texel, vec4(round_to_half(light.rgb), 1.0));
}
