#version 460
// Scattering by importance sampling: n stratified radii of the widest channel at multiples of the
// golden angle. Each tap is weighted by the profile at its 3D distance and by the area of the patch
// at the tap. The result is self-normalised.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "burley/subsurface_burley.bindings.glsl"
#include "common/environment.glsl"
#include "common/tiles.glsl"
#include "common/radius.glsl"
#include "common/half.glsl"
#include "common/hash.glsl"
#include "common/tap.glsl"

const float min_weight = 1e-30; // smaller sums of weights are rounding errors of the exponentials

vec3 scatter(scatter_point point, scatter_profile profile, vec3 own) {
  vec2 pixels_per_mm = 1.0 / pixel_footprint(point.depth);
  vec3 random = unit_from_hash(pcg3d(uvec3(point.pixel, frame.frame_index)));
  float angle = random.y * two_pi;
  vec2 direction = vec2(cos(angle), sin(angle));
  mat2 turn = mat2(cos(golden_angle), sin(golden_angle), -sin(golden_angle), cos(golden_angle));

  vec3 sum = vec3(0.0), total = vec3(0.0);
  for (int i = 0; i < settings.samples; ++i, direction = turn * direction) {
    radial_sample radial =
        profile_sample(profile, 1.0 - (float(i) + random.x) / float(settings.samples));
    vec2 at = vec2(point.pixel) + direction * radial.r * pixels_per_mm;
    surface_tap tap;
    if (!find_tap(material_image, depth_image, slope_image, point.id, at, tap))
      continue;
    vec4 light = texelFetch(light_image, texel_of(tap.pixel), 0);
    vec3 weight = tap_weight(point, profile, tap, radial, light.a);
    sum += weight * light.rgb;
    total += weight;
  }
  bvec3 scattered = bvec3(uvec3(greaterThan(profile.d.rgb, vec3(0.0))) *
                          uvec3(greaterThan(total, vec3(min_weight))));
  vec3 mean = mix(own, sum / max(total, vec3(min_weight)), scattered);
  return mix(mean, own, profile_direct(point.id));
}

void main() {
  ivec2 pixel;
  bool copy_only;
  uint listed = listed_tile();
  if (listed >= tiles_data[0] || !pixel_of_tile(tiles_data[1u + listed], pixel, copy_only))
    return;
  ivec2 texel = texel_of(pixel);
  uint id = profile_of(texelFetch(material_image, texel, 0).r);
  if (id == 0u)
    return;
  vec3 light = texelFetch(light_image, texel, 0).rgb;
  float depth = view_depth(texelFetch(depth_image, texel, 0).r);
  if (!copy_only && depth > 0.0) {
    float scale = has_scatter_scale()
                      ? clean_scatter_scale(texelFetch(scatter_scale_image, texel, 0).r)
                      : 1.0;
    scatter_profile profile = find_profile(id, scale);
    if (projected_d(profile.d.w, depth) >= copy_below_d_px)
      light = scatter(scatter_point(pixel, id, depth, view_position(vec2(pixel), depth)), profile,
                      light);
  }
  imageStore(scattered_image, texel, vec4(round_to_half(light), 1.0));
}
