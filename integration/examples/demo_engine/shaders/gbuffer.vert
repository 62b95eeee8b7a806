#version 460
#extension GL_GOOGLE_include_directive : require
#include "frame.glsl"
#include "object.glsl"

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 uv;
layout(location = 3) in vec4 tangent;
layout(location = 4) in vec3 tint;
layout(location = 5) in vec2 finish;

layout(location = 0) out vec3 object_position;
layout(location = 1) out vec3 world_normal;
layout(location = 2) out vec4 world_tangent;
layout(location = 3) out vec2 texture_uv;
layout(location = 4) out vec3 surface_tint;
layout(location = 5) out vec2 surface_finish;
layout(location = 6) out vec3 clip_now;      // x, y, w
layout(location = 7) out vec3 clip_previous; // x, y, w

void main() {
  vec4 world = vec4(to_world(position), 1.0);
  gl_Position = frame.clip_from_world * world;
  object_position = position;
  world_normal = normal_to_world(normal);
  world_tangent = vec4(to_world(tangent.xyz) - to_world(vec3(0.0)), tangent.w);
  texture_uv = uv;
  surface_tint = tint;
  surface_finish = finish;
  clip_now = (frame.clip_from_world_steady * world).xyw;
  clip_previous = (frame.previous_clip_from_world * vec4(to_previous_world(position), 1.0)).xyw;
}
