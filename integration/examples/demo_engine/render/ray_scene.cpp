#include "integration/examples/demo_engine/render/ray_scene.hpp"

#include <algorithm>
#include <cstring>

namespace demo {
namespace {

constexpr VkBufferUsageFlags read_by_builds =
    VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR |
    VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT;

struct InstanceData { // mirrors restir/instances.glsl
  glm::vec4 world_from_object[3];
  glm::uvec4 place;
};
static_assert(sizeof(InstanceData) == 64);

VkDeviceAddress address_of(const VulkanHost& host, const Buffer& buffer) {
  auto info =
      vulkan_struct<VkBufferDeviceAddressInfo>(VK_STRUCTURE_TYPE_BUFFER_DEVICE_ADDRESS_INFO);
  info.buffer = buffer.buffer;
  return host.vk.vkGetBufferDeviceAddress(host.device, &info);
}

// Builds one structure of one geometry with `count` primitives. Waits for the device.
Result<RayStructure> build(VulkanHost& host, VkAccelerationStructureTypeKHR type,
                           const VkAccelerationStructureGeometryKHR& geometry, uint32_t count) {
  auto info = vulkan_struct<VkAccelerationStructureBuildGeometryInfoKHR>(
      VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_GEOMETRY_INFO_KHR);
  info.type = type;
  info.flags = VK_BUILD_ACCELERATION_STRUCTURE_PREFER_FAST_TRACE_BIT_KHR;
  info.mode = VK_BUILD_ACCELERATION_STRUCTURE_MODE_BUILD_KHR;
  info.geometryCount = 1;
  info.pGeometries = &geometry;
  auto sizes = vulkan_struct<VkAccelerationStructureBuildSizesInfoKHR>(
      VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_BUILD_SIZES_INFO_KHR);
  host.vk.vkGetAccelerationStructureBuildSizesKHR(
      host.device, VK_ACCELERATION_STRUCTURE_BUILD_TYPE_DEVICE_KHR, &info, &count, &sizes);
  RayStructure made;
  made.host = &host;
  auto memory = create_buffer(host, sizes.accelerationStructureSize,
                              VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_STORAGE_BIT_KHR |
                                  VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT,
                              false);
  if (!memory) return memory.error();
  made.memory = memory.take();
  auto create = vulkan_struct<VkAccelerationStructureCreateInfoKHR>(
      VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_CREATE_INFO_KHR);
  create.buffer = made.memory.buffer;
  create.size = sizes.accelerationStructureSize;
  create.type = type;
  const VkResult result =
      host.vk.vkCreateAccelerationStructureKHR(host.device, &create, nullptr, &made.handle);
  if (result != VK_SUCCESS) {
    made.handle = VK_NULL_HANDLE;
    return vulkan_error("vkCreateAccelerationStructureKHR", result);
  }
  // minAccelerationStructureScratchOffsetAlignment is at most this.
  constexpr uint64_t scratch_alignment = 256;
  auto scratch = create_buffer(
      host, std::max<uint64_t>(sizes.buildScratchSize, 1) + scratch_alignment,
      VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_SHADER_DEVICE_ADDRESS_BIT, false);
  if (!scratch) return scratch.error();
  info.dstAccelerationStructure = made.handle;
  info.scratchData.deviceAddress =
      (address_of(host, *scratch) + scratch_alignment - 1) / scratch_alignment * scratch_alignment;
  const VkAccelerationStructureBuildRangeInfoKHR range{count, 0, 0, 0};
  const VkAccelerationStructureBuildRangeInfoKHR* const ranges = &range;
  const auto done = run_commands(host, [&](VkCommandBuffer commands) {
    host.vk.vkCmdBuildAccelerationStructuresKHR(commands, 1, &info, &ranges);
    return success();
  });
  if (!done) return done.error();
  return made;
}

VkAccelerationStructureGeometryKHR geometry_of(VkGeometryTypeKHR type) {
  auto geometry = vulkan_struct<VkAccelerationStructureGeometryKHR>(
      VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_KHR);
  geometry.geometryType = type;
  // Probes need every triangle exactly once.
  geometry.flags = VK_GEOMETRY_NO_DUPLICATE_ANY_HIT_INVOCATION_BIT_KHR;
  return geometry;
}

float power_of(const RayLight& light) {
  const glm::vec3 luminance{0.2126f, 0.7152f, 0.0722f};
  return std::max(0.0f, glm::dot(light.emission, luminance)) *
         (light.type == 1 || light.type == 2 ? light.area : 1.0f);
}

} // namespace

RayStructure& RayStructure::operator=(RayStructure&& other) noexcept {
  std::swap(host, other.host);
  std::swap(handle, other.handle);
  std::swap(memory, other.memory);
  return *this;
}

RayStructure::~RayStructure() {
  if (host != nullptr) host->vk.vkDestroyAccelerationStructureKHR(host->device, handle, nullptr);
}

std::vector<RayLight> make_ray_lights(std::vector<RayLight> lights) {
  if (lights.empty()) lights.emplace_back();
  float sum = 0;
  for (RayLight& light : lights) {
    if (light.type == 1 || light.type == 2)
      light.area =
          glm::length(glm::cross(light.edge_u, light.edge_v)) * (light.type == 2 ? 0.5f : 1.0f);
    sum += power_of(light);
  }
  float until = 0;
  for (RayLight& light : lights) {
    light.fraction = sum > 0 ? power_of(light) / sum : 1.0f / static_cast<float>(lights.size());
    light.until = until += light.fraction;
  }
  return lights;
}

Result<RayScene> create_ray_scene(VulkanHost& host, std::span<const Mesh> meshes) {
  RayScene scene;
  std::vector<glm::vec4> vertices;
  std::vector<uint32_t> indices;
  for (const Mesh& mesh : meshes) {
    scene.first.emplace_back(static_cast<uint32_t>(vertices.size() / 2),
                             static_cast<uint32_t>(indices.size()));
    for (const Vertex& vertex : mesh.vertices) {
      vertices.emplace_back(vertex.position, 1.0f);
      vertices.emplace_back(vertex.normal, 0.0f);
    }
    indices.insert(indices.end(), mesh.indices.begin(), mesh.indices.end());
  }
  constexpr VkBufferUsageFlags usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | read_by_builds;
  auto vertex_buffer = upload_buffer(host, std::as_bytes(std::span(vertices)), usage);
  if (!vertex_buffer) return vertex_buffer.error();
  scene.vertices = vertex_buffer.take();
  auto index_buffer = upload_buffer(host, std::as_bytes(std::span(indices)), usage);
  if (!index_buffer) return index_buffer.error();
  scene.indices = index_buffer.take();
  for (size_t m = 0; m < meshes.size(); ++m) {
    VkAccelerationStructureGeometryKHR geometry = geometry_of(VK_GEOMETRY_TYPE_TRIANGLES_KHR);
    auto& triangles = geometry.geometry.triangles;
    triangles = vulkan_struct<VkAccelerationStructureGeometryTrianglesDataKHR>(
        VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_TRIANGLES_DATA_KHR);
    triangles.vertexFormat = VK_FORMAT_R32G32B32_SFLOAT;
    triangles.vertexStride = 2 * sizeof(glm::vec4);
    triangles.vertexData.deviceAddress =
        address_of(host, scene.vertices) + scene.first[m].x * triangles.vertexStride;
    triangles.maxVertex = static_cast<uint32_t>(std::max<size_t>(meshes[m].vertices.size(), 1) - 1);
    triangles.indexType = VK_INDEX_TYPE_UINT32;
    triangles.indexData.deviceAddress =
        address_of(host, scene.indices) + scene.first[m].y * sizeof(uint32_t);
    auto made = build(host, VK_ACCELERATION_STRUCTURE_TYPE_BOTTOM_LEVEL_KHR, geometry,
                      static_cast<uint32_t>(meshes[m].indices.size() / 3));
    if (!made) return made.error();
    scene.meshes.push_back(made.take());
  }
  return scene;
}

Result<> place_rays(VulkanHost& host, RayScene& scene, std::span<const RayInstance> instances,
                    const std::vector<RayLight>& lights) {
  std::vector<InstanceData> data;
  std::vector<VkAccelerationStructureInstanceKHR> placed;
  for (const RayInstance& instance : instances) {
    InstanceData& one = data.emplace_back();
    VkAccelerationStructureInstanceKHR& at = placed.emplace_back();
    at = {};
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 4; ++c)
        at.transform.matrix[r][c] = one.world_from_object[r][c] =
            static_cast<float>(instance.world_from_object[c][r]);
    one.place = glm::uvec4(scene.first[instance.mesh], instance.profile, 0u);
    at.instanceCustomIndex = static_cast<uint32_t>(data.size() - 1) & 0xffffffu;
    at.mask = 0xff;
    auto info = vulkan_struct<VkAccelerationStructureDeviceAddressInfoKHR>(
        VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_DEVICE_ADDRESS_INFO_KHR);
    info.accelerationStructure = scene.meshes[instance.mesh].handle;
    at.accelerationStructureReference =
        host.vk.vkGetAccelerationStructureDeviceAddressKHR(host.device, &info);
  }
  auto instance_buffer =
      upload_buffer(host, std::as_bytes(std::span(data)), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
  if (!instance_buffer) return instance_buffer.error();
  scene.instances = instance_buffer.take();
  const std::vector<RayLight> shared = make_ray_lights(lights);
  auto light_buffer =
      upload_buffer(host, std::as_bytes(std::span(shared)), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
  if (!light_buffer) return light_buffer.error();
  scene.lights = light_buffer.take();
  auto top = upload_buffer(host, std::as_bytes(std::span(placed)), read_by_builds);
  if (!top) return top.error();
  VkAccelerationStructureGeometryKHR geometry = geometry_of(VK_GEOMETRY_TYPE_INSTANCES_KHR);
  geometry.geometry.instances = vulkan_struct<VkAccelerationStructureGeometryInstancesDataKHR>(
      VK_STRUCTURE_TYPE_ACCELERATION_STRUCTURE_GEOMETRY_INSTANCES_DATA_KHR);
  geometry.geometry.instances.data.deviceAddress = address_of(host, *top);
  auto made = build(host, VK_ACCELERATION_STRUCTURE_TYPE_TOP_LEVEL_KHR, geometry,
                    static_cast<uint32_t>(placed.size()));
  if (!made) return made.error();
  scene.top = made.take();
  return success();
}

} // namespace demo
