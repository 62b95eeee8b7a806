#version 460
// Sums the levels of the plain pyramid with the pixel's own weights, and divides by the same sum of
// their masks. Each level is read through a cubic B-spline as four filtered reads (Sigg & Hadwiger
// 2005).
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "papers/subsurface_pyramid_gather.bindings.glsl"
#include "common/environment.glsl"
#include "common/tiles.glsl"
#include "common/radius.glsl"
#include "common/half.glsl"
#include "afis/pyramid.glsl"
#include "sap/sap.glsl"

const float min_fraction = 0.001; // a level with less weight is not worth its reads

vec4 spline_read(texture2D level, vec2 at) {
  vec2 low = floor(at), t = at - low, s = 1.0 - t;
  vec2 w0 = s * s * s / 6.0, w1 = 2.0 / 3.0 - 0.5 * t * t * (2.0 - t);
  vec2 w3 = t * t * t / 6.0, w2 = 1.0 - w0 - w1 - w3;
  vec2 before = w0 + w1, after = w2 + w3;
  vec2 a = low - 1.0 + w1 / before, b = low + 1.0 + w3 / after;
  return before.y *
             (before.x * pyramid_read(level, a) + after.x * pyramid_read(level, vec2(b.x, a.y))) +
         after.y *
             (before.x * pyramid_read(level, vec2(a.x, b.y)) + after.x * pyramid_read(level, b));
}

// Adds a level's light and mask with its fraction of `left`. Returns the remaining fraction, never
// below 0.
vec3 add_level(texture2D level, int index, uint id, vec3 d_px, vec2 pixel, vec3 left,
               inout vec3 sum, inout vec3 total) {
  vec3 fraction = index == 0 ? sap_lookup(id, sap_plain, 1, d_px)
                             : left * sap_lookup(id, sap_plain, index + 1, d_px);
  if (max(fraction.r, max(fraction.g, fraction.b)) >= min_fraction) {
    vec4 light = spline_read(level, (pixel + 0.5) / sap_spacings(index) - 0.5);
    sum += fraction * light.rgb;
    total += fraction * light.a;
  }
  return max(left - fraction, vec3(0.0));
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
  vec3 light = texelFetch(level_0_image, pixel + pyramid_border, 0).rgb;
  float depth = view_depth(texelFetch(depth_image, texel, 0).r);
  if (!copy_only && depth > 0.0) {
    float scale = has_scatter_scale()
                      ? clean_scatter_scale(texelFetch(scatter_scale_image, texel, 0).r)
                      : 1.0;
    vec3 d_px = profiles[min(id, 255u)].d_mm.rgb * (scale / sap_footprint(depth));
    vec3 centre = sap_lookup(id, sap_plain, 0, d_px);
    vec3 direct = profile_direct(id), left = 1.0 - centre;
    // Light that never scatters needs no surface around.
    vec3 total = max(centre - direct, vec3(0.0)), sum = total * light;
    vec2 at = vec2(pixel);
    left = add_level(level_0_image, 0, id, d_px, at, left, sum, total);
    left = add_level(level_1_image, 1, id, d_px, at, left, sum, total);
    left = add_level(level_2_image, 2, id, d_px, at, left, sum, total);
    left = add_level(level_3_image, 3, id, d_px, at, left, sum, total);
    left = add_level(level_4_image, 4, id, d_px, at, left, sum, total);
    left = add_level(level_5_image, 5, id, d_px, at, left, sum, total);
    left = add_level(level_6_image, 6, id, d_px, at, left, sum, total);
    left = add_level(level_7_image, 7, id, d_px, at, left, sum, total);
    add_level(level_8_image, 8, id, d_px, at, left, sum, total);
    vec3 mean = mix(light, sum / max(total, vec3(1e-12)), greaterThan(total, vec3(1e-12)));
    light = mix(mean, light, direct);
  }
  imageStore(scattered_image, texel, round_to_half(vec4(light, 1.0)));
}
