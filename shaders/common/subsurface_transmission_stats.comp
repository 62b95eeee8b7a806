#version 460
// Measures the transmitted light for the choice: the mean square, over the pixels with subsurface
// of a tile, of the exposed light that a slab of their thickness transmits (slab.glsl). Integer
// sums do not depend on the order. transmitted_rms of passes/common/environment.hpp evaluates the
// result on the host.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "common/constants_math.glsl"
#include "common/subsurface_transmission_stats.bindings.glsl"
#include "common/environment.glsl"
#include "constants.glsl"
#include "common/counters.glsl"
#include "common/radius.glsl"
#include "common/slab.glsl"
#include "common/tiles.glsl"

// steps per squared exposed luminance of 1; 64 pixels fit 32 bits
const float pixel_steps = 65536.0;

shared uint squares, pixels;

vec3 transmitted_light(ivec2 texel, uint id) {
  float scale = 1.0, metres = texelFetch(thickness_image, texel, 0).r;
  if (has_scatter_scale())
    scale = clean_scatter_scale(texelFetch(scatter_scale_image, texel, 0).r);
  return light_through_slab(id, scale, metres, texelFetch(back_lighting_image, texel, 0).rgb);
}

void main() {
  if (gl_LocalInvocationIndex == 0u) {
    squares = 0u;
    pixels = 0u;
  }
  barrier();
  ivec2 pixel;
  bool copy_only;
  uint listed = listed_tile();
  if (listed < tiles_data[0] && pixel_of_tile(tiles_data[1u + listed], pixel, copy_only)) {
    ivec2 texel = texel_of(pixel);
    uint id = profile_of(texelFetch(material_image, texel, 0).r);
    if (id != 0u) {
      vec3 light = transmitted_light(texel, id);
      float exposed = min(frame.exposure * dot(luminance_weights, light), 1.0);
      atomicAdd(squares, uint(exposed * exposed * pixel_steps));
      atomicAdd(pixels, 1u);
    }
  }
  barrier();
  if (gl_LocalInvocationIndex == 0u && squares != 0u) {
    float mean = float(squares) / (float(pixels) * pixel_steps);
    atomicAdd(counters.through_steps, uint(mean * through_square_steps + 0.5));
  }
}
