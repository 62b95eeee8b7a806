#pragma once
// The scene for ray queries: acceleration structures, and the buffers that graphs import beside them
// (docs/pass_types.md, restir.initial). Made only where the device has VK_KHR_ray_query.

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

// As shaders of graphs read it; 64 bytes.
struct RayLight {
  glm::vec3 position{
      0.0f};              // point: where; parallelogram: a corner; directional: unit vector towards the light
  uint32_t type = 0;      // 0 point, 1 parallelogram, 2 triangle, 3 directional
  glm::vec3 edge_u{0.0f}; // parallelogram: it shines where cross(edge_u, edge_v) points
  float fraction = 1;     // probability of being picked: set by make_ray_lights
  glm::vec3 edge_v{0.0f};
  float area = 1;           // directional: length of its shadow rays
  glm::vec3 emission{0.0f}; // point: intensity; parallelogram: radiance; directional: irradiance
  float until = 1;          // set by make_ray_lights
};
static_assert(sizeof(RayLight) == 64);

// Shares by emitted power, never 0 for a light that shines. At least one light: a dark one where there is
// none.
std::vector<RayLight> make_ray_lights(std::vector<RayLight> lights);

struct RayStructure { // owns the structure; dies before its host
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
  std::vector<RayStructure> meshes; // bottom levels
  RayStructure top;
  std::vector<glm::uvec2> first; // of each mesh: vertex, index
};

// What commands leave behind that build them: for a binding's `before`.
inline constexpr VkPipelineStageFlags2 ray_build_stages =
    VK_PIPELINE_STAGE_2_ACCELERATION_STRUCTURE_BUILD_BIT_KHR;
inline constexpr VkAccessFlags2 ray_build_access = VK_ACCESS_2_ACCELERATION_STRUCTURE_WRITE_BIT_KHR;

// Bottom levels of all meshes. Waits for the device. Errors: environment.
Result<RayScene> create_ray_scene(VulkanHost& host, std::span<const Mesh> meshes);
// Instances, lights and top level anew; the device must be idle. Waits for it. Errors: environment.
Result<> place_rays(VulkanHost& host, RayScene& scene, std::span<const RayInstance> instances,
                    const std::vector<RayLight>& lights);

} // namespace demo
