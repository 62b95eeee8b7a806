#version 460
// Evaluates the functions of accumulate.glsl for case x, one row per question:
//   row 0  clip_to_neighbours
//   row 1  add_frame
//   row 2  catmull_rom
//   row 3  remainder_of; can_be_kept
//   row 4  light_of_remainder
// A case is five rows of the table of questions; see accumulate_test.cpp in this folder.
#extension GL_GOOGLE_include_directive : require
#include "common/environment.glsl"
#include "common/accumulate.glsl"
layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0, rgba32f) uniform writeonly image2D target;
layout(push_constant) uniform push_block { uint port_mask; };

const int rows_of_case = 5;

void main() {
  ivec2 at = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(at, imageSize(target))))
    return;
  int first = rows_of_case * at.x;
  accumulated_light history =
      accumulated_light(separable_rows[first].rgb, separable_rows[first].a);
  vec4 mean = separable_rows[first + 1]; // light, reach
  vec4 deviation = separable_rows[first + 2]; // light, smallest weight of a frame
  vec4 light = separable_rows[first + 3]; // light, part
  vec3 near = separable_rows[first + 4].rgb;
  vec4 answer = catmull_rom(light.a);
  if (at.y == 0) {
    accumulated_light clipped = clip_to_neighbours(history, mean.rgb, deviation.rgb, mean.a);
    answer = vec4(clipped.light, clipped.count);
  }
  if (at.y == 1) {
    accumulated_light sum = add_frame(history, light.rgb, deviation.a);
    answer = vec4(sum.light, sum.count);
  }
  if (at.y == 3) {
    vec3 remainder = remainder_of(light.rgb, near, mean.rgb);
    answer = vec4(remainder, float(can_be_kept(remainder)));
  }
  if (at.y == 4)
    answer = vec4(light_of_remainder(history.light, near, mean.rgb), 0.0);
  imageStore(target, at, answer);
}
