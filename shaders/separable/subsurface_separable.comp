#version 460
// One pass along an axis over the tiles with subsurface (separable/separable_pass.glsl).
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_EXT_samplerless_texture_functions : require
#include "separable/subsurface_separable.bindings.glsl"
#include "common/environment.glsl"
#include "common/half.glsl"
#include "common/sanitise.glsl"
#include "common/tiles.glsl"
#include "separable/separable_pass.glsl"
#include "separable/surface.glsl"

vec4 light_at(ivec2 texel) {
  return settings.axis == AXIS_VERTICAL ? texelFetch(blurred_image, texel, 0)
                                        : texelFetch(light_image, texel, 0);
}

float depth_at(ivec2 texel) { return texelFetch(view_depth_image, texel, 0).r; }

void main() {
  ivec2 pixel = ivec2(0);
  bool copy_only = false;
  uint tile = listed_tile();
  bool listed = tile < tiles_data[0] && pixel_of_tile(tiles_data[1u + tile], pixel, copy_only);
  ivec2 texel = texel_of(pixel);
  bool vertical = settings.axis == AXIS_VERTICAL, scatters = false;
  vec4 light = vec4(0.0), own = vec4(0.0);
  float d = 0.0;
  if (listed) {
    light = texelFetch(light_image, texel, 0);
    own = light;
    d = profiles[uint(light.a)].d_mm.w;
    if (has_scatter_scale())
      d *= clean_scatter_scale(texelFetch(scatter_scale_image, texel, 0).r);
    scatters = !copy_only && scatters_at(uint(light.a), d, depth_at(texel));
    if (scatters && vertical)
      own = texelFetch(blurred_image, texel, 0);
  }
  separable_pass how = separable_pass(vertical, settings.taps, settings.kernel);
  vec3 result = scatter(how, pixel, scatters, uint(light.a), d, light, own);
  if (listed && light.a > 0.0)
    imageStore(scattered_image, texel, vec4(round_to_half(result), vertical ? 1.0 : light.a));
}
