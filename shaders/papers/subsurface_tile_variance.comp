#version 460
// Estimates by how much samples reduce a tile's error: the variation of the light that reaches the
// tile, times the benefit of samples over the separable technique and the host's importance.
// Variation is the mean deviation of 8x8 taps from their mean. The taps cover a square that grows
// with the tile's widest d, and each reads the level of the mips whose texels have the distance
// between taps. If light reaches no further than the tile, the taps are the tile's pixels. Integer
// sums do not depend on the order.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "common/constants_math.glsl"
#include "papers/subsurface_tile_variance.bindings.glsl"
#include "common/environment.glsl"
#include "common/sanitise.glsl"
#include "common/radius.glsl"
#include "common/tiles.glsl"
#include "afis/mips.glsl"

// Steps for one pixel under exposed light of 1, as in subsurface.tile_error_estimate.
const float contrast_steps = 1024.0;
const float weight_steps = 32.0;
const float largest_weight = 12.0; // the product of all sums fits 32 bits
// Side of the square over d; 8 ranks tiles best of 4, 8 and 16 (docs/papers.md, like benefit_of).
const float square_side_d = 8.0;

shared uint light_sum, tap_count, contrast_sum, weight_sum, widest_d;

// Returns the error of the separable technique relative to that of samples, minus 1. `area`: of the
// pixel's patch in footprints, below 1 off the axis of a perspective view.
float benefit_of(float d_px, float area) {
  float tilt = max(area - 1.0, 0.0);
  return max(settings.ratio * sqrt(max(d_px, 1.0)) * (1.0 + 4.0 * tilt) - 1.0, 0.0);
}

uint exposed_steps(vec3 light) {
  float exposed = dot(light, luminance_weights) * frame.exposure;
  return uint(clamp(exposed, 0.0, 4.0) * contrast_steps + 0.5);
}

// Returns d in pixels, or 0 if the pixel's light does not scatter.
float scattering_d(ivec2 texel, uint id) {
  float depth = view_depth(texelFetch(depth_image, texel, 0).r);
  float scale =
      has_scatter_scale() ? clean_scatter_scale(texelFetch(scatter_scale_image, texel, 0).r) : 1.0;
  float d_px = depth > 0.0 ? projected_d(profiles[min(id, 255u)].d_mm.w * scale, depth) : 0.0;
  return d_px >= copy_below_d_px ? d_px : 0.0;
}

void main() {
  if (gl_LocalInvocationIndex == 0u)
    light_sum = tap_count = contrast_sum = weight_sum = widest_d = 0u;
  barrier();
  uint tile = listed_tile();
  ivec2 pixel = ivec2(0);
  bool copy_only = false;
  bool listed = tile < tiles_data[0] && pixel_of_tile(tiles_data[1u + tile], pixel, copy_only);
  ivec2 texel = texel_of(pixel);
  uint id = listed && !copy_only ? profile_of(texelFetch(material_image, texel, 0).r) : 0u;
  if (id != 0u) {
    float importance =
        has_importance() ? clean_importance(texelFetch(importance_image, texel, 0).r) : 1.0;
    float own_d = scattering_d(texel, id);
    float weight = importance * benefit_of(own_d, texelFetch(light_image, texel, 0).a);
    if (own_d > 0.0) {
      atomicAdd(weight_sum, uint(min(weight, largest_weight) * weight_steps + 0.5));
      atomicMax(widest_d, floatBitsToUint(own_d));
    }
  }
  barrier();
  float d_px = uintBitsToFloat(widest_d);
  float spacing = max(1.0, square_side_d / 8.0 * d_px);
  vec2 in_tile = vec2(gl_LocalInvocationID.xy) - 3.5;
  vec2 at = vec2(pixel) + in_tile * (spacing - 1.0);
  ivec2 place = ivec2(floor(at + 0.5));
  bool taps =
      d_px > 0.0 && inside_bounds(place) && texelFetch(material_image, texel_of(place), 0).r != 0u;
  uint seen = 0u;
  if (taps) {
    vec3 nearest = texelFetch(light_image, texel_of(place), 0).rgb;
    seen = exposed_steps(filtered_light(levels_image, MIPS_TRILINEAR, at, log2(spacing), nearest));
    atomicAdd(light_sum, seen);
    atomicAdd(tap_count, 1u);
  }
  barrier();
  if (taps) {
    uint mean = (light_sum + tap_count / 2u) / tap_count;
    atomicAdd(contrast_sum, max(seen, mean) - min(seen, mean));
  }
  barrier();
  if (listed && gl_LocalInvocationIndex == 0u) {
    int index = (pixel.y >> 3) * frame.tiles.x + (pixel.x >> 3);
    bool varies = float(contrast_sum) >= settings.min_contrast * contrast_steps * float(tap_count);
    uint divisor = max(tap_count, 1u) * uint(weight_steps);
    tile_errors_data[index] = varies ? contrast_sum * weight_sum / divisor : 0u;
    tile_d_data[index] = widest_d;
  }
}
