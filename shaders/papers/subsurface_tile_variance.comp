#version 460
// Measures how much light varies inside a tile: the deviation of its pixels from the tile's mean,
// times the host's importance. Integer sums do not depend on the order.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "common/constants_math.glsl"
#include "papers/subsurface_tile_variance.bindings.glsl"
#include "common/environment.glsl"
#include "common/tiles.glsl"

// Steps for one pixel under exposed light of 1, as in subsurface.tile_error_estimate.
const float contrast_steps = 1024.0;

shared uint light_sum, pixel_count, contrast_sum;

void main() {
  if (gl_LocalInvocationIndex == 0u)
    light_sum = pixel_count = contrast_sum = 0u;
  barrier();
  uint tile = listed_tile();
  ivec2 pixel = ivec2(0);
  bool copy_only = false;
  bool listed = tile < tiles_data[0] && pixel_of_tile(tiles_data[1u + tile], pixel, copy_only);
  ivec2 texel = texel_of(pixel);
  bool counts = listed && !copy_only && texelFetch(material_image, texel, 0).r != 0u;
  uint seen = 0u;
  if (counts) {
    float exposed = dot(texelFetch(light_image, texel, 0).rgb, luminance_weights) * frame.exposure;
    seen = uint(clamp(exposed, 0.0, 4.0) * contrast_steps + 0.5);
    atomicAdd(light_sum, seen);
    atomicAdd(pixel_count, 1u);
  }
  barrier();
  if (counts) {
    uint mean = (light_sum + pixel_count / 2u) / pixel_count;
    float matters =
        has_importance() ? clamp(texelFetch(importance_image, texel, 0).r, 0.0, 1.0) : 1.0;
    atomicAdd(contrast_sum, uint(float(max(seen, mean) - min(seen, mean)) * matters + 0.5));
  }
  barrier();
  if (listed && gl_LocalInvocationIndex == 0u)
    tile_errors_data[(pixel.y >> 3) * frame.tiles.x + (pixel.x >> 3)] =
        contrast_sum >= uint(settings.min_contrast * contrast_steps * 64.0) ? contrast_sum : 0u;
}
