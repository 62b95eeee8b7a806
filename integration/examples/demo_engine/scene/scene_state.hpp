#pragma once
// State of a scene at one moment as matrices. Pure arithmetic, no device.

#include "integration/examples/demo_engine/scene/scene.hpp"

#include <glm/glm.hpp>

#include <vector>

namespace demo {

struct ViewDesc {
  uint32_t width = 1, height = 1; // pixels
  bool reversed_depth = false;
  bool jitter = false;
};

// Matrices for Vulkan's clip space (y down, depth 0..1). View space: x right, y up, looking along
// -z.
struct ViewState {
  glm::dmat4 clip_from_view{1.0};        // with jitter
  glm::dmat4 clip_from_view_steady{1.0}; // without jitter
  glm::dmat4 view_from_world{1.0};
  glm::dvec2 jitter{0.0}; // pixels, +x right, +y down
};

struct SceneState {
  double seconds = 0.0;
  bool cut = false; // the camera has jumped since the previous frame
  ViewState now, previous;
  std::vector<glm::dmat4> world, previous_world; // by object
  std::vector<uint32_t> first_layer;             // by light; no_layer: no shadow
  std::vector<glm::dmat4> shadow_from_world;     // by layer; depth 0..1 from the light
};

inline constexpr uint32_t no_layer = 0xffffffffu;
inline constexpr uint32_t max_shadow_layers = 24;
inline constexpr uint32_t shadow_map_size = 1024; // texels per side

// Returns the number of shadow maps that a light needs.
uint32_t shadow_layers_of(const Light& light);
// Returns the direction from the light to its target, in the world; -z if both coincide.
glm::dvec3 direction_of(const Light& light, double seconds);

// Returns the state of a frame. In frame 0 and in the first frame after a cut, the previous state
// equals the present one.
SceneState state_at(const Scene& scene, uint32_t frame, const ViewDesc& desc);

// Returns the metres along the view axis of a depth value, for any projection of the kind above.
double view_depth(const glm::dmat4& clip_from_view, double depth);

} // namespace demo
