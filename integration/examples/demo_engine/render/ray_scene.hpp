#pragma once
// The scene for ray queries: acceleration structures, and the buffers that graphs import in
// addition
// (`dermis docs`: pass_types.md, restir.initial). Made only where the device has VK_KHR_ray_query.

#include "integration/examples/demo_engine/geometry/mesh.hpp"
#include "integration/examples/demo_engine/vulkan_image.hpp"

#include <glm/glm.hpp>

#include <array>
#include <span>
#include <vector>

namespace demo {

struct RayInstance {
  uint32_t mesh = 0;
  uint32_t profile = 0;              // id, 0 = no subsurface
  glm::dmat4 world_from_object{1.0}; // metres
};

// A light as the graph's shaders read it; 64 bytes.
struct RayLight {
  // point: position; parallelogram: a corner; directional: unit vector towards the light
  glm::vec3 position{0.0f};
  uint32_t type = 0;      // 0 point, 1 parallelogram, 2 triangle, 3 directional
  glm::vec3 edge_u{0.0f}; // parallelogram: emits towards cross(edge_u, edge_v)
  float fraction = 1;     // probability of selection, set by make_ray_lights
  glm::vec3 edge_v{0.0f};
  float area = 1;           // directional: length of its shadow rays
  glm::vec3 emission{0.0f}; // point: intensity; parallelogram: radiance; directional: irradiance
  float until = 1;          // sum of fractions, set by make_ray_lights
};
static_assert(sizeof(RayLight) == 64);

// Sets selection probabilities by emitted power, never 0 for a light that emits. Returns at least
// one light: a dark light if there is none.
std::vector<RayLight> make_ray_lights(std::vector<RayLight> lights);

// Owns the structure; must be destroyed before its host.
struct RayStructure {
  const VulkanHost* host = nullptr;
  VkAccelerationStructureKHR handle = VK_NULL_HANDLE;
  Buffer memory;

  RayStructure() = default;
  RayStructure(RayStructure&& other) noexcept { *this = std::move(other); }
  RayStructure& operator=(RayStructure&& other) noexcept;
  ~RayStructure();
};

struct RayScene {
  Buffer vertices, indices, instances, lights;
  std::vector<RayStructure> meshes; // bottom-level structures
  RayStructure top;
  std::vector<glm::uvec2> first; // first vertex and index of each mesh
};

// Stages and access of the commands that build the structures, for a binding's `before`.
inline constexpr VkPipelineStageFlags2 ray_build_stages =
    VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR;
inline constexpr VkAccessFlags2 ray_build_access = VK_ACCESS_2_ACCELERATION_STRUCTURE_WRITE_BIT_KHR;

// Builds the bottom-level structures of all meshes. Waits for the device. Errors: environment.
Result<RayScene> create_ray_scene(VulkanHost& host, std::span<const Mesh> meshes);
// Rebuilds instances, lights and the top level. The device must be idle. Waits for the device.
// Errors: environment.
Result<> place_rays(VulkanHost& host, RayScene& scene, std::span<const RayInstance> instances,
                    const std::vector<RayLight>& lights);

} // namespace demo
