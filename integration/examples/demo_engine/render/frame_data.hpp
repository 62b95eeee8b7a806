#pragma once
// Shader data; mirrors shaders/frame.glsl, object.glsl and gbuffer.frag. glm stores columns, as
// GLSL does.

#include "integration/examples/demo_engine/scene/scene_state.hpp"

#include <glm/glm.hpp>

#include <cstddef>
#include <cstdint>

namespace demo {

inline constexpr uint32_t max_lights = 8;
inline constexpr uint32_t max_objects = 256;
inline constexpr uint32_t no_shadow = 0xffffffffu;

struct LightData {
  glm::vec4 position, direction, intensity;
  glm::uvec4 shadow;
};

struct FrameData {
  glm::mat4 clip_from_world, clip_from_world_steady, previous_clip_from_world, view_from_world,
      view_from_clip;
  glm::vec4 sky, ground, background, up, size, misc;
  glm::uvec4 counts;
  LightData lights[max_lights];
  glm::mat4 shadow_from_view[max_shadow_layers];
};
static_assert(offsetof(FrameData, lights) == 5 * 64 + 7 * 16);
static_assert(sizeof(LightData) == 64 &&
              sizeof(FrameData) == 432 + max_lights * 64 + max_shadow_layers * 64);

struct ObjectData {
  glm::vec4 world[3], previous[3]; // rows
  uint32_t material, layer;
};
static_assert(sizeof(ObjectData) == 104); // within the 128 bytes that every device supports

struct MaterialData {
  glm::vec4 albedo, finish;
  glm::uvec4 kind;
};

// How scattered light reaches the composite; FrameData::counts.y.
enum class Scattering : uint32_t { none = 0, in_place = 1, apart = 2 };

} // namespace demo
