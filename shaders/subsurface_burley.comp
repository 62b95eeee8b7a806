#version 460
// Scattering by importance sampling: n stratified radii of the widest channel at the golden angle, each tap weighted
// by the profile at its true distance and by the area of the patch it falls on; self-normalised.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "subsurface_burley.bindings.glsl"
#include "environment.glsl"
#include "tiles.glsl"
#include "radius.glsl"
#include "half.glsl"
#include "burley.glsl"
#include "hash.glsl"

const float golden_angle = 2.39996322972865332; // pi (3 - sqrt 5)
const float two_pi = 6.28318530717958648;

vec3 scatter(ivec2 pixel, uint id, float depth, vec3 d, float d_max, vec3 own) {
  vec2 pixels_per_mm = 1.0 / pixel_footprint(depth);
  vec3 position = view_position(vec2(pixel), depth);
  vec3 random = unit_from_hash(pcg3d(uvec3(pixel, frame.frame_index)));
  float angle = random.y * two_pi;
  vec2 direction = vec2(cos(angle), sin(angle));
  mat2 turn = mat2(cos(golden_angle), sin(golden_angle), -sin(golden_angle), cos(golden_angle));
  vec3 inverse_d = 1.0 / max(d, vec3(1e-30));

  vec3 sum = vec3(0.0), total = vec3(0.0);
  for (int i = 0; i < settings.samples; ++i, direction = turn * direction) {
    float survival = 1.0 - (float(i) + random.x) / float(settings.samples);
    float r = burley_sample_survival(survival, d_max);
    vec2 tap = vec2(pixel) + direction * r * pixels_per_mm;
    ivec2 q = ivec2(round(clamp(tap, vec2(-1.0), vec2(frame.rect.zw)))); // integers are centres
    if (!inside_rect(q))
      continue;
    ivec2 texel = texel_of(q);
    if (texelFetch(material_image, texel, 0).r != id)
      continue;
    float tap_depth = view_depth(texelFetch(depth_image, texel, 0).r);
    if (tap_depth <= 0.0)
      continue;
    vec4 light = texelFetch(light_image, texel, 0);
    vec2 slope = texelFetch(slope_image, texel, 0).rg;
    // The sample's own point on the patch, not the patch's centre: the truth averages over the patch.
    float point_depth = tap_depth + dot(slope * pixel_footprint(tap_depth), tap - vec2(q));
    float distance_3d = max(length(view_position(tap, point_depth) - position), 1e-12);
    // Weight in channel c: R_c(distance) * area / density, with density = pdf(r) / (2 pi r) on the view plane at the
    // pixel's depth; 2 pi R_c = pdf_c(distance) / distance.
    float zoom = is_perspective() ? tap_depth / depth : 1.0;
    float tap_weight = burley_sample_weight(survival) / burley_pdf(r, d_max) * (r / distance_3d) * light.a * zoom * zoom;
    vec3 e = exp(-distance_3d * inverse_d * (1.0 / 3.0));
    vec3 weight = tap_weight * 0.25 * inverse_d * (e * e * e + e);
    sum += weight * light.rgb;
    total += weight;
  }
  return vec3(d.r > 0.0 && total.r > 0.0 ? sum.r / total.r : own.r, d.g > 0.0 && total.g > 0.0 ? sum.g / total.g : own.g,
              d.b > 0.0 && total.b > 0.0 ? sum.b / total.b : own.b);
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
  vec3 light = texelFetch(light_image, texel, 0).rgb;
  float depth = view_depth(texelFetch(depth_image, texel, 0).r);
  if (!copy_only && depth > 0.0) {
    float scale = has_scatter_scale() ? clean_scatter_scale(texelFetch(scatter_scale_image, texel, 0).r) : 1.0;
    vec4 d = profiles[min(id, 255u)].d_mm * scale;
    if (projected_d(d.w, depth) >= copy_below_d_px)
      light = scatter(pixel, id, depth, d.rgb, d.w, light);
  }
  imageStore(scattered_image, texel, vec4(round_to_half(light), 1.0));
}
