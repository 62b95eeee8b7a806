#pragma once
// A scene's meshes, materials and maps on the device.

#include "integration/examples/demo_engine/geometry/mesh.hpp"
#include "integration/examples/demo_engine/render/pipeline.hpp"
#include "integration/examples/demo_engine/scene/scene.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace demo {

// A texture with four bytes per texel, row by row from the top.
struct Texture {
  uint32_t width = 0, height = 0; // 0: none
  std::vector<std::byte> texels;
};

// The model that replaces objects of shape "model".
struct Model {
  Mesh mesh; // empty: none
  Texture albedo, normal, specular;
  glm::dvec3 albedo_factor{1.0};
  double normal_scale = 1.0; // of the normal map's x and y
  std::vector<std::string> credits, warnings;
};

struct GpuMesh {
  Buffer vertices, indices;
  uint32_t index_count = 0;
};

struct SceneGpu {
  std::vector<GpuMesh> meshes;
  std::vector<Mesh> shapes;             // copies of the meshes if the device has ray queries
  std::vector<uint32_t> mesh_of;        // by object
  std::vector<VkDescriptorSet> maps_of; // by object
  Buffer materials;
  std::vector<Image> images;
  uint64_t triangles = 0; // number for all objects
};

// Builds each shape once. `maps` is the layout of the set with albedo, normal and specular map.
// Errors: usage (a shape "model" without a model), environment.
Result<SceneGpu> load_scene(VulkanHost& host, const Scene& scene, const Model& model,
                            const OwnedDescriptorPool& pool, const OwnedSetLayout& maps,
                            VkSampler sampler);

} // namespace demo
