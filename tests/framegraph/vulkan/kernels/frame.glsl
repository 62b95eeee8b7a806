// The environment of the test kernels: set 1.
layout(std140, set = 1, binding = 0) uniform frame_block {
  ivec4 rect; // x, y, width, height in texels
  float time;
} frame;
layout(std430, set = 1, binding = 1) readonly buffer table_block { float table[]; };
layout(set = 1, binding = 2) uniform sampler linear_sampler;
