#version 460
// Evaluates the functions of guidance.glsl for case x, one row per question:
//   row 0  required_samples, clamped_samples of the result, clamped_samples of the request,
// control_weight
//   row 1  add_value: mean, variance
//   row 2  add_values: means of f and g, covariance, variance of g
// A case is four rows of the table of questions; see guidance_test.cpp.
#extension GL_GOOGLE_include_directive : require
#include "common/environment.glsl"
#include "afis/guidance.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0, rgba32f) uniform writeonly image2D target;
layout(push_constant) uniform push_block { uint port_mask; };

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, frame.rect.zw)))
    return;
  vec4 set = separable_rows[4 * pixel.x], requested = separable_rows[4 * pixel.x + 1];
  vec4 kept = separable_rows[4 * pixel.x + 2], found = separable_rows[4 * pixel.x + 3];
  guidance_settings settings =
      guidance_settings(set.x, set.y, set.z, 0.0, set.w, int(requested.x), int(requested.y));
  moving_covariance moments = moving_covariance(kept.x, kept.y, kept.z, kept.w);
  vec4 answer = vec4(0.0);
  if (pixel.y == 0) {
    float required = required_samples(requested.z, requested.w, settings);
    answer = vec4(required, clamped_samples(required, settings), clamped_samples(found.w, settings),
                  control_weight(moments, settings.eps_alpha));
  }
  if (pixel.y == 1) {
    moving_variance now = add_value(moving_variance(kept.x, kept.w), found.x, found.z);
    answer.xy = vec2(now.mean, now.variance);
  }
  if (pixel.y == 2) {
    moving_covariance now = add_values(moments, found.x, found.y, found.z);
    answer = vec4(now.mean_f, now.mean_g, now.covariance, now.variance_g);
  }
  imageStore(target, pixel, answer);
}
