#version 460
// Estimates the error of each tile: the sum over its pixels of (threshold - confidence) /
// threshold, times the exposed luminance change by scattering, times the host's importance. Without
// `light`, the luminance itself replaces the change. Integer sums do not depend on the order.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "common/constants_math.glsl"
#include "sap/subsurface_tile_error_estimate.bindings.glsl"
#include "common/environment.glsl"
#include "common/sanitise.glsl"
#include "common/tiles.glsl"
#include "sap/sap.glsl"

const float error_steps = 1024.0; // steps for the error of one pixel under exposed light of 1

shared uint sum;

void main() {
  if (gl_LocalInvocationIndex == 0u)
    sum = 0u;
  barrier();
  uint tile = listed_tile();
  ivec2 pixel = ivec2(0);
  bool copy_only = false;
  bool listed = tile < tiles_data[0] && pixel_of_tile(tiles_data[1u + tile], pixel, copy_only);
  if (listed && !copy_only) {
    ivec2 texel = texel_of(pixel);
    if (texelFetch(material_image, texel, 0).r != 0u) {
      vec4 light = texelFetch(scattered_image, texel, 0);
      float missing_confidence =
          clamp((settings.below - light.a) / max(settings.below, 1e-6), 0.0, 1.0);
      float pixel_error = dot(light.rgb, luminance_weights);
      if (has_light()) {
        vec4 before = texelFetch(light_image, texel, 0);
        if (has_surface())
          before = sap_light(texelFetch(surface_image, texel, 0), before);
        pixel_error = abs(pixel_error - dot(before.rgb, luminance_weights));
      }
      float exposed_error = clamp(pixel_error * frame.exposure, 0.0, 4.0);
      float importance =
          has_importance() ? clean_importance(texelFetch(importance_image, texel, 0).r) : 1.0;
      atomicAdd(sum, uint(missing_confidence * exposed_error * importance * error_steps + 0.5));
    }
  }
  barrier();
  if (listed && gl_LocalInvocationIndex == 0u)
    tile_errors_data[(pixel.y >> 3) * frame.tiles.x + (pixel.x >> 3)] = sum;
}
