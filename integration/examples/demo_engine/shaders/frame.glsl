// Frame constants of every program of the demo engine; mirrors render/frame_data.hpp.
#ifndef DEMO_FRAME_GLSL
#define DEMO_FRAME_GLSL

const uint max_lights = 8u;
const uint max_shadow_layers = 24u;
const uint light_directional = 0u;
const uint light_point = 1u;
const uint light_spot = 2u;
const uint no_shadow = 0xffffffffu;

struct Light {
  vec4 position;  // view space; w = type
  vec4 direction; // view space, direction of travel; w = cosine of the outer cone
  vec4 intensity; // rgb; w = cosine of the inner cone
  uvec4 shadow;   // x = first layer or no_shadow
};

layout(set = 0, binding = 0, std140) uniform Frame {
  mat4 clip_from_world;          // with jitter
  mat4 clip_from_world_steady;   // without jitter
  mat4 previous_clip_from_world; // without jitter
  mat4 view_from_world;
  mat4 view_from_clip;
  vec4 sky;        // rgb: ambient light from above
  vec4 ground;     // rgb: ambient light from below
  vec4 background; // rgb
  vec4 up;         // view space
  vec4 size;       // pixels, 1 / pixels
  // x = depth of the background, y = exposure, z = shadow texel in uv, w = 1 for orthographic
  vec4 misc;
  uvec4 counts;    // x = number of lights, y = storage of scattered light (composite.comp)
  Light lights[max_lights];
  mat4 shadow_from_view[max_shadow_layers];
} frame;

const float pi = 3.14159265358979;

vec3 view_position(vec2 pixel_center, float depth) {
  vec4 p = frame.view_from_clip * vec4(pixel_center * frame.size.zw * 2.0 - 1.0, depth, 1.0);
  return p.xyz / p.w;
}

#endif
