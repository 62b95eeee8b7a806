#include "integration/examples/demo_engine/render/taa.hpp"

#include "demo_shaders/taa_comp.h"

#include <cstring>

namespace demo {
namespace {

// Mirrors shaders/taa.comp.
struct TaaData {
  glm::vec2 jitter; // pixels
  uint32_t begins;  // 1: no history
  uint32_t unused;  // rounds the block to 16 bytes
};

Result<> create_images(Taa& taa, const Renderer& renderer) {
  VulkanHost& host = *renderer.host;
  ImageDesc desc;
  desc.format = target_info(Target::color).format;
  desc.width = renderer.view.width;
  desc.height = renderer.view.height;
  desc.usage =
      VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
  for (Image& image : taa.resolved) {
    auto made = create_image(host, desc);
    if (!made) return made.error();
    image = made.take();
  }
  auto constants = create_buffer(host, sizeof(TaaData), VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT, true);
  if (!constants) return constants.error();
  taa.constants = constants.take();
  return run_commands(host, [&](VkCommandBuffer commands) {
    for (const Image& image : taa.resolved)
      transition(host, commands, image, {}, resting);
    return success();
  });
}

} // namespace

Result<std::unique_ptr<Taa>> create_taa(const Renderer& renderer) {
  VulkanHost& host = *renderer.host;
  auto taa = std::make_unique<Taa>();
  if (auto done = create_images(*taa, renderer); !done) return done.error();
  auto pool = create_descriptor_pool(host, static_cast<uint32_t>(taa->sets.size()));
  if (!pool) return pool.error();
  taa->pool = pool.take();
  constexpr VkDescriptorType texture = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
  constexpr VkShaderStageFlags stage = VK_SHADER_STAGE_COMPUTE_BIT;
  auto program = create_compute(host, taa_comp,
                                {{{VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, stage},
                                  {texture, stage},
                                  {texture, stage},
                                  {texture, stage},
                                  {VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, stage}}});
  if (!program) return program.error();
  taa->program = program.take();
  for (uint32_t i = 0; i < taa->sets.size(); ++i) {
    auto set = allocate_set(host, taa->pool, taa->program.layout.sets[0]);
    if (!set) return set.error();
    taa->sets[i] = *set;
    write_buffer(host, *set, 0, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, taa->constants);
    const VkImageView read[] = {renderer[Target::color].view, renderer[Target::velocity].view,
                                taa->resolved[1 - i].view};
    for (uint32_t b = 0; b < std::size(read); ++b)
      write_image(host, *set, 1 + b, texture, read[b], resting.layout,
                  renderer.texel_sampler.handle);
    write_image(host, *set, 4, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, taa->resolved[i].view,
                VK_IMAGE_LAYOUT_GENERAL, VK_NULL_HANDLE);
  }
  return taa;
}

void record_taa(Taa& taa, const Renderer& renderer, VkCommandBuffer commands,
                const SceneState& state) {
  const VulkanHost& host = *renderer.host;
  const TaaData data = {glm::vec2(state.now.jitter), !taa.begun || state.cut ? 1u : 0u, 0u};
  std::memcpy(taa.constants.mapped, &data, sizeof(data));
  taa.begun = true;
  taa.newest = 1 - taa.newest;
  constexpr uint32_t tile = 8; // local size of the kernel
  const Image& out = taa.resolved[taa.newest];
  transition(host, commands, out, resting, storage_target);
  host.vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, taa.program.pipeline.handle);
  host.vk.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE,
                                  taa.program.layout.layout.handle, 0, 1, &taa.sets[taa.newest], 0,
                                  nullptr);
  host.vk.vkCmdDispatch(commands, (renderer.view.width + tile - 1) / tile,
                        (renderer.view.height + tile - 1) / tile, 1);
  transition(host, commands, out, storage_target, resting);
}

const Image& taa_result(const Taa& taa) {
  return taa.resolved[taa.newest];
}

} // namespace demo
