#version 460
#extension GL_GOOGLE_include_directive : require
#include "object.glsl"

layout(set = 0, binding = 0, std430) readonly buffer Shadows { mat4 shadow_from_world[]; } shadows;
layout(location = 0) in vec3 position;

void main() {
  gl_Position = shadows.shadow_from_world[object.layer] * vec4(to_world(position), 1.0);
}
