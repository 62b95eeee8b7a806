#version 460
// Computes out = (10 * mode + bias) * (negate ? -1 : 1), plus 1000 * more where `more` is bound,
// plus 100 if the presence of `more` is a constant.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "frame.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(set = 0, binding = 0) uniform texture2D more;
layout(set = 0, binding = 1, r32f) uniform writeonly image2D target;
layout(constant_id = 1) const uint bound_ports = 0u;
layout(constant_id = 2) const uint changing_ports = 0xffffffffu;
layout(constant_id = 17) const int mode = -1;
layout(constant_id = 18) const bool negate = false;
layout(push_constant) uniform push_block { uint port_mask; float bias; };

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, frame.rect.zw))) return;
  bool changing = (changing_ports & 1u) != 0u;
  bool bound = (bound_ports & 1u) != 0u || (changing && (port_mask & 1u) != 0u);
  float value = (10.0 * float(mode) + bias) * (negate ? -1.0 : 1.0);
  if (bound) value += 1000.0 * texelFetch(more, pixel, 0).x;
  if (!changing) value += 100.0;
  imageStore(target, pixel, vec4(value, 0, 0, 0));
}
