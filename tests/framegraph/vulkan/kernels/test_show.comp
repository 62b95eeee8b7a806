#version 460
// Copies the first component of the bound image, float or unsigned; writes -1 outside of the image.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "frame.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0) uniform texture2D a;
layout(set = 0, binding = 1) uniform utexture2D ids;
layout(set = 0, binding = 2, r32f) uniform writeonly image2D target;
layout(push_constant) uniform push_block { uint port_mask; };

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, frame.rect.zw))) return;
  bool has_ids = (port_mask & 2u) != 0u;
  float value = -1.0;
  if (has_ids && all(lessThan(pixel, textureSize(ids, 0))))
    value = float(texelFetch(ids, pixel, 0).x) / 32.0;
  if (!has_ids && all(lessThan(pixel, textureSize(a, 0)))) value = texelFetch(a, pixel, 0).x;
  imageStore(target, pixel, vec4(value));
}
