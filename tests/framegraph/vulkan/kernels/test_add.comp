#version 460
// Computes out = a + b + bias if b is bound, else a + bias - 1000 * (value of the placeholder,
// which must be 0).
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "frame.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0) uniform texture2D a;
layout(set = 0, binding = 1) uniform texture2D b;
layout(set = 0, binding = 2) uniform utexture2D ids;
layout(set = 0, binding = 3, r32f) uniform writeonly image2D target;
layout(set = 0, binding = 4, rgba16f) uniform writeonly image2D second;
layout(set = 0, binding = 5) readonly buffer weights_block { float weights[]; };
layout(push_constant) uniform push_block { uint port_mask; float bias; };

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, frame.rect.zw))) return;
  pixel += frame.rect.xy;
  float sum = texelFetch(a, pixel, 0).x + bias;
  bool has_b = (port_mask & 2u) != 0u, has_ids = (port_mask & 4u) != 0u,
       has_weights = (port_mask & 32u) != 0u;
  sum += has_b ? texelFetch(b, pixel, 0).x : -1000.0 * texelFetch(b, ivec2(0), 0).x;
  sum += has_ids ? float(texelFetch(ids, pixel, 0).x)
                 : -1000.0 * float(texelFetch(ids, ivec2(0), 0).x);
  sum += has_weights ? 0.0 : -1000.0 * weights[0];
  imageStore(target, pixel, vec4(sum, 0, 0, 0));
  if ((port_mask & 16u) != 0u) imageStore(second, pixel, vec4(-sum));
}
