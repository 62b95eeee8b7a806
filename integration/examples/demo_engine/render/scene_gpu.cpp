#include "integration/examples/demo_engine/render/scene_gpu.hpp"

#include "integration/examples/demo_engine/geometry/bust.hpp"
#include "integration/examples/demo_engine/geometry/ear.hpp"
#include "integration/examples/demo_engine/geometry/shapes.hpp"
#include "integration/examples/demo_engine/render/frame_data.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <optional>

namespace demo {
namespace {

constexpr ImageState sampled = {VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                                VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT,
                                VK_ACCESS_2_SHADER_SAMPLED_READ_BIT};

Mesh make(Shape shape, const Model& model) {
  switch (shape) {
  case Shape::bust:
    return make_bust();
  case Shape::ear:
    return make_ear();
  case Shape::knot:
    return make_knot();
  case Shape::candle:
    return make_candle();
  case Shape::sphere:
    return make_sphere();
  case Shape::plane:
    return make_plane();
  case Shape::box:
    return make_box();
  case Shape::model:
    return model.mesh;
  }
  return {};
}

Result<GpuMesh> upload(VulkanHost& host, const Mesh& mesh) {
  auto vertices = upload_buffer(host, std::as_bytes(std::span(mesh.vertices)),
                                VK_BUFFER_USAGE_VERTEX_BUFFER_BIT);
  if (!vertices) return vertices.error();
  auto indices =
      upload_buffer(host, std::as_bytes(std::span(mesh.indices)), VK_BUFFER_USAGE_INDEX_BUFFER_BIT);
  if (!indices) return indices.error();
  return GpuMesh{vertices.take(), indices.take(), static_cast<uint32_t>(mesh.indices.size())};
}

Result<Image> upload(VulkanHost& host, const Texture& texture, VkFormat format) {
  const uint32_t mips =
      static_cast<uint32_t>(std::bit_width(std::max(texture.width, texture.height)));
  constexpr VkImageUsageFlags usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT |
                                      VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
  ImageDesc desc;
  desc.format = format;
  desc.width = texture.width;
  desc.height = texture.height;
  desc.mips = mips;
  desc.usage = usage;
  auto image = create_image(host, desc);
  if (!image) return image.error();
  if (auto done = upload_texels(host, *image, texture.texels, sampled); !done) return done.error();
  return image;
}

Texture single_texel(uint8_t r, uint8_t g, uint8_t b) {
  return {1, 1, {std::byte{r}, std::byte{g}, std::byte{b}, std::byte{255}}};
}

MaterialData material_of(const Object& object, const Model& model) {
  const bool is_model = object.shape == Shape::model;
  const glm::dvec3 albedo = is_model ? object.albedo * model.albedo_factor : object.albedo;
  MaterialData data{};
  data.albedo = glm::vec4(glm::vec3(albedo), static_cast<float>(object.roughness));
  data.finish =
      glm::vec4(object.reflectance, object.emission, is_model ? model.normal_scale : 1.0, 0.0f);
  data.kind = glm::uvec4(object.profile, static_cast<uint32_t>(object.pattern), 0u, 0u);
  return data;
}

} // namespace

Result<SceneGpu> load_scene(VulkanHost& host, const Scene& scene, const Model& model,
                            const OwnedDescriptorPool& pool, const OwnedSetLayout& maps,
                            VkSampler sampler) {
  SceneGpu gpu;
  const Texture white = single_texel(255, 255, 255), flat = single_texel(128, 128, 255);
  const auto or_else = [](const Texture& texture, const Texture& other) {
    return texture.width > 0 ? texture : other;
  };
  struct Maps {
    Texture texture;
    VkFormat format;
  };
  const std::array<Maps, 6> textures = {
      {{white, VK_FORMAT_R8G8B8A8_UNORM},
       {flat, VK_FORMAT_R8G8B8A8_UNORM},
       {white, VK_FORMAT_R8G8B8A8_UNORM},
       {or_else(model.albedo, white), VK_FORMAT_R8G8B8A8_SRGB},
       {or_else(model.normal, flat), VK_FORMAT_R8G8B8A8_UNORM},
       {or_else(model.specular, white), VK_FORMAT_R8G8B8A8_UNORM}}};
  for (const Maps& one : textures) {
    auto image = upload(host, one.texture, one.format);
    if (!image) return image.error();
    gpu.images.push_back(image.take());
  }
  std::array<VkDescriptorSet, 2> sets{}; // for plain objects, for the model
  for (uint32_t s = 0; s < sets.size(); ++s) {
    auto set = allocate_set(host, pool, maps);
    if (!set) return set.error();
    sets[s] = *set;
    for (uint32_t i = 0; i < 3; ++i)
      write_image(host, sets[s], i, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                  gpu.images[s * 3 + i].view, sampled.layout, sampler);
  }

  std::array<std::optional<uint32_t>, 8> made{}; // by shape
  std::vector<MaterialData> materials;
  for (const Object& object : scene.objects) {
    auto& index = made[static_cast<size_t>(object.shape)];
    if (!index) {
      Mesh mesh = make(object.shape, model);
      if (mesh.indices.empty())
        return Error{ErrorKind::usage,
                     "scene '" + scene.name +
                         "' has an object of shape 'model' and no model was given: add --model"};
      auto uploaded = upload(host, mesh);
      if (!uploaded) return uploaded.error();
      index = static_cast<uint32_t>(gpu.meshes.size());
      gpu.meshes.push_back(uploaded.take());
      if (host.ray_query) gpu.shapes.push_back(std::move(mesh));
    }
    gpu.mesh_of.push_back(*index);
    gpu.maps_of.push_back(sets[object.shape == Shape::model ? 1 : 0]);
    gpu.triangles += gpu.meshes[*index].index_count / 3;
    materials.push_back(material_of(object, model));
  }
  auto buffer =
      upload_buffer(host, std::as_bytes(std::span(materials)), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT);
  if (!buffer) return buffer.error();
  gpu.materials = buffer.take();
  return gpu;
}

} // namespace demo
