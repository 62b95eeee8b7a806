#version 460
// Filtered importance sampling in its published form: one chain of mips holds light and, in alpha,
// view depth in metres. A sample is one read, whose depth is taken as that of the surface; profiles
// and patches are not known there, so light mixes over depth steps and between profiles.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "papers/subsurface_afis_published.bindings.glsl"
#include "common/constants_math.glsl"
#include "common/environment.glsl"
#include "common/half.glsl"
#include "common/radial_draw.glsl"
#include "common/radius.glsl"
#include "common/sequence.glsl"
#include "common/tiles.glsl"

layout(set = 1, binding = 3) uniform sampler linear_sampler;

const float last_mip = 8.0;

vec3 scatter(ivec2 pixel, uint id, scatter_profile profile, vec4 own) {
  float depth = own.a * mm_per_metre;
  vec2 footprint = pixel_footprint(depth);
  // Samples lie beyond the direct radius only; the pixel's own light covers the radii within it.
  float r0 = 0.5 * min(footprint.x, footprint.y);
  vec3 survival = profile_survival(profile, r0);
  float beyond = survival[profiles[min(id, 255u)].widest];
  vec3 direct = 1.0 - survival;
  float pixels_per_sample =
      two_pi * beyond / (float(settings.samples) * footprint.x * footprint.y);
  uvec2 offset = offset_from_hash(pcg3d16(uvec3(pixel, 0u)).xy);
  uint first = frame.frame_index * uint(settings.samples);
  vec2 texel = 1.0 / vec2(textureSize(chain_image, 0));
  vec3 sum = vec3(0.0), total = vec3(0.0);
  for (int i = 0; i < settings.samples; ++i) {
    vec2 unit = unit_from_fixed(r2_point(offset, first + uint(i)));
    radial_sample radial =
        radial_draw(profile, unit.x * beyond, INVERSE_POLYNOMIAL, WEIGHTING_SAMPLER);
    vec2 at =
        vec2(pixel) + radial.r * vec2(cos(unit.y * two_pi), sin(unit.y * two_pi)) / footprint;
    // The sampler would repeat the first row and column beyond the picture.
    if (any(lessThan(at, vec2(-0.5))) || any(greaterThanEqual(at, vec2(frame.rect.zw) - 0.5)))
      continue;
    float lod =
        0.5 * log2(max(pixels_per_sample * radial.r / radial.density, 1e-20)) + settings.lod_bias;
    vec4 tap = textureLod(sampler2D(chain_image, linear_sampler), (at + 0.5) * texel,
                          clamp(lod, 0.0, last_mip));
    if (tap.a <= 0.0)
      continue;
    float rise = tap.a * mm_per_metre - depth;
    vec3 weight = profile_falloff(profile, sqrt(radial.r * radial.r + rise * rise)) * radial.r /
                  radial.density;
    sum += weight * tap.rgb;
    total += weight;
  }
  float each = beyond / float(settings.samples);
  vec3 mass = direct + each * total, mean = direct * own.rgb + each * sum;
  mean = mix(own.rgb, mean / max(mass, vec3(1e-30)), greaterThan(mass, vec3(1e-30)));
  mean = mix(own.rgb, mean, greaterThan(profile.d.rgb, vec3(0.0)));
  return mix(mean, own.rgb, profile_direct(id));
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
  vec4 own = texelFetch(chain_image, pixel, 0);
  if (!copy_only && own.a > 0.0) {
    float scale = has_scatter_scale()
                      ? clean_scatter_scale(texelFetch(scatter_scale_image, texel, 0).r)
                      : 1.0;
    scatter_profile profile = find_profile(id, scale);
    if (projected_d(profile.d.w, own.a * mm_per_metre) >= copy_below_d_px)
      own.rgb = scatter(pixel, id, profile, own);
  }
  imageStore(scattered_image, texel, vec4(round_to_half(own.rgb), 1.0));
}
