#version 460
// Evaluates the kernels' profile functions for profile id y / 3 + 1. Row 0: 2 pi R, row 1: the
// survival of 2^(x / 16 - 8) d, row 2: the sampler's radius and density for a survival of 2^(-x /
// 16). Lengths in mm.
#extension GL_GOOGLE_include_directive : require
#include "common/profile.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0, rgba32f) uniform writeonly image2D target;
layout(push_constant) uniform push_block { uint port_mask; };

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, frame.rect.zw)))
    return;
  scatter_profile profile = find_profile(uint(pixel.y / 3 + 1), 1.0);
  float r = exp2(float(pixel.x) / 16.0 - 8.0) * profile.d.w;
  vec3 result = vec3(0.0);
  if (pixel.y % 3 == 0)
    result = profile_falloff(profile, r);
  if (pixel.y % 3 == 1)
    result = profile_survival(profile, r);
  if (pixel.y % 3 == 2) {
    radial_sample radial = profile_sample(profile, exp2(-float(pixel.x) / 16.0));
    result.xy = vec2(radial.r, radial.density);
  }
  imageStore(target, pixel, vec4(result, 0.0));
}
