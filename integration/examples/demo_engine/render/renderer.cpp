#include "integration/examples/demo_engine/render/renderer.hpp"

#include "demo_shaders/composite_comp.h"
#include "demo_shaders/gbuffer_frag.h"
#include "demo_shaders/gbuffer_vert.h"
#include "demo_shaders/lighting_comp.h"
#include "demo_shaders/shadow_vert.h"

#include <algorithm>

namespace demo {
namespace {

constexpr VkImageUsageFlags attachment_usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT |
                                               VK_IMAGE_USAGE_SAMPLED_BIT |
                                               VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
constexpr VkImageUsageFlags stored =
    VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
constexpr VkImageUsageFlags tested = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT |
                                     VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;

constexpr std::array<TargetInfo, target_count> target_infos = {{
    {"depth", VK_FORMAT_D32_SFLOAT, tested},
    {"normal", VK_FORMAT_R16G16B16A16_SFLOAT, attachment_usage},
    {"", VK_FORMAT_R16G16B16A16_SFLOAT, attachment_usage},
    {"albedo", VK_FORMAT_R8G8B8A8_SRGB, attachment_usage},
    {"material", VK_FORMAT_R8_UINT, attachment_usage},
    {"", VK_FORMAT_R8G8B8A8_UNORM, attachment_usage},
    {"velocity", VK_FORMAT_R16G16_SFLOAT, attachment_usage},
    {"lighting", VK_FORMAT_R16G16B16A16_SFLOAT, stored},
    {"", VK_FORMAT_R16G16B16A16_SFLOAT, stored},
    {"scattered_light", VK_FORMAT_R16G16B16A16_SFLOAT, stored},
    {"", VK_FORMAT_R32G32B32A32_SFLOAT, stored},
    {"thickness", VK_FORMAT_R32_SFLOAT, stored},
    {"back_lighting", VK_FORMAT_R16G16B16A16_SFLOAT, stored},
    {"sampling", VK_FORMAT_R16G16B16A16_SFLOAT, stored},
    {"tile_class", VK_FORMAT_R16G16B16A16_SFLOAT, stored},
}};

constexpr VkDescriptorType uniform = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
constexpr VkDescriptorType storage = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
constexpr VkDescriptorType texture = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
constexpr VkDescriptorType image = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
constexpr VkShaderStageFlags vertex_stage = VK_SHADER_STAGE_VERTEX_BIT;
constexpr VkShaderStageFlags both_stages =
    VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
constexpr VkShaderStageFlags fragment_stage = VK_SHADER_STAGE_FRAGMENT_BIT;
constexpr VkShaderStageFlags compute_stage = VK_SHADER_STAGE_COMPUTE_BIT;

Result<> create_targets(Renderer& renderer, const RendererDesc& desc) {
  VulkanHost& host = *renderer.host;
  for (size_t i = 0; i < target_count; ++i) {
    ImageDesc image_desc;
    image_desc.format = target_infos[i].format;
    image_desc.width = desc.view.width;
    image_desc.height = desc.view.height;
    image_desc.usage = target_infos[i].usage | desc.more_usage[i];
    auto made = create_image(host, image_desc);
    if (!made) return made.error();
    renderer.targets[i] = made.take();
  }
  uint32_t layers = 0;
  for (const Light& light : renderer.scene->lights)
    layers += shadow_layers_of(light);
  ImageDesc shadows;
  shadows.format = VK_FORMAT_D32_SFLOAT;
  shadows.width = shadow_map_size;
  shadows.height = shadow_map_size;
  shadows.layers = std::max(layers, 2u); // at least 2, so that the view is always an array view
  shadows.usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT;
  auto made = create_image(host, shadows);
  if (!made) return made.error();
  renderer.shadow_maps = made.take();
  auto frame = create_buffer(host, sizeof(FrameData), VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT, true);
  if (!frame) return frame.error();
  renderer.frame_buffer = frame.take();
  auto shadow = create_buffer(host, sizeof(glm::mat4) * max_shadow_layers,
                              VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, true);
  if (!shadow) return shadow.error();
  renderer.shadow_buffer = shadow.take();
  return run_commands(host, [&](VkCommandBuffer commands) {
    for (const Image& target : renderer.targets)
      transition(host, commands, target, {}, resting);
    transition(host, commands, renderer.shadow_maps, {}, resting);
    return success();
  });
}

Result<> create_pipelines(Renderer& renderer) {
  VulkanHost& host = *renderer.host;
  auto shadow = create_layout(host, {{{storage, vertex_stage}}}, sizeof(ObjectData), vertex_stage);
  if (!shadow) return shadow.error();
  renderer.shadow_layout = shadow.take();
  GraphicsDesc depth_only;
  depth_only.vertex = shadow_vert;
  depth_only.depth_bias = true;
  depth_only.position_only = true;
  auto shadow_pipeline = create_graphics(host, depth_only, renderer.shadow_layout);
  if (!shadow_pipeline) return shadow_pipeline.error();
  renderer.shadow_pipeline = shadow_pipeline.take();

  auto gbuffer = create_layout(
      host,
      {{{uniform, both_stages}, {storage, fragment_stage}},
       {{texture, fragment_stage}, {texture, fragment_stage}, {texture, fragment_stage}}},
      sizeof(ObjectData), both_stages);
  if (!gbuffer) return gbuffer.error();
  renderer.gbuffer_layout = gbuffer.take();
  GraphicsDesc drawing;
  drawing.vertex = gbuffer_vert;
  drawing.fragment = gbuffer_frag;
  for (const Target target : {Target::normal, Target::shading, Target::albedo, Target::material,
                              Target::finish, Target::velocity})
    drawing.colors.push_back(target_info(target).format);
  drawing.compare = renderer.view.reversed_depth ? VK_COMPARE_OP_GREATER : VK_COMPARE_OP_LESS;
  auto gbuffer_pipeline = create_graphics(host, drawing, renderer.gbuffer_layout);
  if (!gbuffer_pipeline) return gbuffer_pipeline.error();
  renderer.gbuffer_pipeline = gbuffer_pipeline.take();

  std::vector<Binding> bindings(9, Binding{texture, compute_stage});
  bindings[0].type = uniform;
  bindings[8].type = image;
  auto composite = create_compute(host, composite_comp, {bindings});
  if (!composite) return composite.error();
  renderer.composite = composite.take();
  bindings.resize(11, Binding{texture, compute_stage});
  bindings[8].type = texture;
  for (const size_t written : {6u, 7u, 9u, 10u})
    bindings[written].type = image;
  auto lighting = create_compute(host, lighting_comp, {bindings});
  if (!lighting) return lighting.error();
  renderer.lighting = lighting.take();
  return success();
}

Result<> create_sets(Renderer& renderer) {
  VulkanHost& host = *renderer.host;
  const auto allocate = [&](const OwnedSetLayout& layout, VkDescriptorSet& out) -> Result<> {
    auto set = allocate_set(host, renderer.pool, layout);
    if (!set) return set.error();
    out = *set;
    return success();
  };
  if (auto done = allocate(renderer.shadow_layout.sets[0], renderer.shadow_set); !done) return done;
  if (auto done = allocate(renderer.gbuffer_layout.sets[0], renderer.gbuffer_set); !done)
    return done;
  if (auto done = allocate(renderer.lighting.layout.sets[0], renderer.lighting_set); !done)
    return done;
  if (auto done = allocate(renderer.composite.layout.sets[0], renderer.composite_set); !done)
    return done;
  write_buffer(host, renderer.shadow_set, 0, storage, renderer.shadow_buffer);
  for (const VkDescriptorSet set :
       {renderer.gbuffer_set, renderer.lighting_set, renderer.composite_set})
    write_buffer(host, set, 0, uniform, renderer.frame_buffer);
  write_buffer(host, renderer.gbuffer_set, 1, storage, renderer.gpu.materials);

  const auto read = [&](VkDescriptorSet set, uint32_t binding, Target target) {
    write_image(host, set, binding, texture, renderer[target].view, resting.layout,
                renderer.texel_sampler.handle);
  };
  const auto write = [&](VkDescriptorSet set, uint32_t binding, Target target) {
    write_image(host, set, binding, image, renderer[target].view, VK_IMAGE_LAYOUT_GENERAL,
                VK_NULL_HANDLE);
  };
  read(renderer.lighting_set, 1, Target::depth);
  read(renderer.lighting_set, 2, Target::normal);
  read(renderer.lighting_set, 3, Target::shading);
  read(renderer.lighting_set, 4, Target::finish);
  write_image(host, renderer.lighting_set, 5, texture, renderer.shadow_maps.view, resting.layout,
              renderer.shadow_sampler.handle);
  write(renderer.lighting_set, 6, Target::lighting);
  write(renderer.lighting_set, 7, Target::specular);
  write_image(host, renderer.lighting_set, 8, texture, renderer.shadow_maps.view, resting.layout,
              renderer.texel_sampler.handle);
  write(renderer.lighting_set, 9, Target::thickness);
  write(renderer.lighting_set, 10, Target::back_lighting);
  read(renderer.composite_set, 1, Target::depth);
  read(renderer.composite_set, 2, Target::lighting);
  read(renderer.composite_set, 3, Target::specular);
  read(renderer.composite_set, 4, Target::albedo);
  read(renderer.composite_set, 5, Target::material);
  read(renderer.composite_set, 6, Target::finish);
  read(renderer.composite_set, 7, Target::scattered);
  write(renderer.composite_set, 8, Target::color);
  return success();
}

Result<> create_queries(Renderer& renderer) {
  if (renderer.host->timestamp_mask == 0) return success();
  auto info = vulkan_struct<VkQueryPoolCreateInfo>(VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO);
  info.queryType = VK_QUERY_TYPE_TIMESTAMP;
  info.queryCount = timestamp_count;
  VkQueryPool queries = VK_NULL_HANDLE;
  const VkResult result =
      renderer.host->vk.vkCreateQueryPool(renderer.host->device, &info, nullptr, &queries);
  if (result != VK_SUCCESS) return vulkan_error("vkCreateQueryPool", result);
  renderer.queries = OwnedQueryPool(*renderer.host, queries);
  return success();
}

} // namespace

const TargetInfo& target_info(Target target) {
  return target_infos[static_cast<size_t>(target)];
}

Result<std::unique_ptr<Renderer>> create_renderer(VulkanHost& host, const Scene& scene,
                                                  const Model& model, const RendererDesc& desc) {
  auto renderer = std::make_unique<Renderer>();
  renderer->host = &host;
  renderer->scene = &scene;
  renderer->view = desc.view;
  if (auto done = create_targets(*renderer, desc); !done) return done.error();
  struct SamplerSlot {
    Sampling sampling;
    OwnedSampler& out;
  };
  for (const SamplerSlot& one : {SamplerSlot{Sampling::nearest, renderer->texel_sampler},
                                 SamplerSlot{Sampling::smooth, renderer->map_sampler},
                                 SamplerSlot{Sampling::compare, renderer->shadow_sampler}}) {
    auto sampler = create_sampler(host, one.sampling);
    if (!sampler) return sampler.error();
    one.out = sampler.take();
  }
  constexpr uint32_t sets = 8; // four for the passes, two for the scene, two spare
  auto pool = create_descriptor_pool(host, sets);
  if (!pool) return pool.error();
  renderer->pool = pool.take();
  if (auto done = create_pipelines(*renderer); !done) return done.error();
  auto gpu = load_scene(host, scene, model, renderer->pool, renderer->gbuffer_layout.sets[1],
                        renderer->map_sampler.handle);
  if (!gpu) return gpu.error();
  renderer->gpu = gpu.take();
  if (auto done = create_sets(*renderer); !done) return done.error();
  if (auto done = create_queries(*renderer); !done) return done.error();
  return renderer;
}

double elapsed_ms(Renderer& renderer, Timestamp from, Timestamp to) {
  if (!renderer.queries.host) return 0.0;
  VulkanHost& host = *renderer.host;
  std::array<uint64_t, 2> ticks{};
  for (size_t i = 0; i < 2; ++i)
    if (host.vk.vkGetQueryPoolResults(host.device, renderer.queries.handle, i == 0 ? from : to, 1,
                                      sizeof(uint64_t), &ticks[i], sizeof(uint64_t),
                                      VK_QUERY_RESULT_64_BIT) != VK_SUCCESS)
      return 0.0;
  const uint64_t passed = (ticks[1] - ticks[0]) & host.timestamp_mask;
  return static_cast<double>(passed) * static_cast<double>(host.properties.limits.timestampPeriod) *
         1e-6;
}

} // namespace demo
