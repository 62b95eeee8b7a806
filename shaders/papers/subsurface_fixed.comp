#version 460
// Plain importance sampling of the widest channel at n points of the R2 sequence, with another
// rotation for every pixel and frame: no mips, no history. Light within the direct radius is the
// pixel's own light.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "papers/subsurface_fixed.bindings.glsl"
#include "common/environment.glsl"
#include "common/tiles.glsl"
#include "common/radius.glsl"
#include "common/half.glsl"
#include "common/hash.glsl"
#include "common/sequence.glsl"
#include "common/tap.glsl"
#include "common/radial_draw.glsl"

// `footprints`: of the pixel's patch, as surface_patch.
vec3 scatter(scatter_point point, scatter_profile profile, float footprints, vec3 own) {
  vec2 footprint = pixel_footprint(point.depth);
  uvec3 hash = pcg3d(uvec3(point.pixel, frame.frame_index));
  uint widest = profiles[min(point.id, 255u)].widest;

  // Samples lie beyond the direct radius only. The radius comes from the sampler itself, so that
  // the pixel's own light covers exactly the radii that the sampler leaves out.
  vec3 direct = vec3(0.0);
  float beyond = 1.0;
  if (settings.direct != DIRECT_NONE) {
    float r0 = settings.direct == DIRECT_INSCRIBED ? 0.5 * min(footprint.x, footprint.y)
                                                   : 0.5 * length(footprint);
    beyond = profile_survival(profile, r0)[widest];
    r0 = radial_draw(profile, beyond, settings.inverse, settings.weighting).r;
    direct = 1.0 - profile_survival(profile, r0 * sqrt(footprints));
  }
  vec3 sum = vec3(0.0), total = vec3(0.0);
  for (int i = 0; i < settings.samples; ++i) {
    vec2 unit = unit_from_fixed(r2_point(hash.xy, uint(i)));
    radial_sample radial =
        radial_draw(profile, unit.x * beyond, settings.inverse, settings.weighting);
    vec2 offset = radial.r * vec2(cos(unit.y * two_pi), sin(unit.y * two_pi));
    surface_tap tap;
    if (!find_tap(material_image, depth_image, slope_image, point.id,
                  vec2(point.pixel) + offset / footprint, tap))
      continue;
    vec4 light = texelFetch(light_image, texel_of(tap.pixel), 0);
    vec3 weight = tap_weight(point, profile, tap, radial, light.a);
    sum += weight * light.rgb;
    total += weight;
  }
  float each = beyond / float(settings.samples);
  vec3 mean = direct * own + each * sum;
  if (settings.normalise == NORMALISE_SELF) {
    vec3 mass = direct + each * total;
    mean = mix(own, mean / max(mass, vec3(1e-30)), greaterThan(mass, vec3(1e-30)));
  }
  mean = mix(own, mean, greaterThan(profile.d.rgb, vec3(0.0)));
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
  vec4 light = texelFetch(light_image, texel, 0);
  float depth = view_depth(texelFetch(depth_image, texel, 0).r);
  if (!copy_only && depth > 0.0) {
    float scale = has_scatter_scale()
                      ? clean_scatter_scale(texelFetch(scatter_scale_image, texel, 0).r)
                      : 1.0;
    scatter_profile profile = find_profile(id, scale);
    if (projected_d(profile.d.w, depth) >= copy_below_d_px)
      light.rgb = scatter(scatter_point(pixel, id, depth, view_position(vec2(pixel), depth)),
                          profile, light.a, light.rgb);
  }
  imageStore(scattered_image, texel, vec4(round_to_half(light.rgb), 1.0));
}
