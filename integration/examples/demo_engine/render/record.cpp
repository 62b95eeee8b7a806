#include "integration/examples/demo_engine/render/renderer.hpp"

#include <cmath>
#include <cstring>

namespace demo {
namespace {

constexpr ImageState color_target = {VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                                     VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
                                     VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT};
constexpr ImageState depth_target = {
    VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL,
    VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
    VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT};

constexpr std::array gbuffer_targets = {Target::normal,   Target::shading, Target::albedo,
                                        Target::material, Target::finish,  Target::velocity};

constexpr std::array lit_targets = {Target::lighting, Target::specular, Target::thickness,
                                    Target::back_lighting};

void stamp(Renderer& renderer, VkCommandBuffer commands, Timestamp which) {
  if (renderer.queries.host)
    renderer.host->vk.vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                           renderer.queries.handle, which);
}

VkRenderingAttachmentInfo attachment(VkImageView view, VkImageLayout layout) {
  auto info = vulkan_struct<VkRenderingAttachmentInfo>(VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO);
  info.imageView = view;
  info.imageLayout = layout;
  info.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
  info.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
  return info;
}

void begin_drawing(const VulkanHost& host, VkCommandBuffer commands, VkExtent2D extent,
                   std::span<const VkRenderingAttachmentInfo> colors,
                   const VkRenderingAttachmentInfo& depth) {
  auto info = vulkan_struct<VkRenderingInfo>(VK_STRUCTURE_TYPE_RENDERING_INFO);
  info.renderArea.extent = extent;
  info.layerCount = 1;
  info.colorAttachmentCount = static_cast<uint32_t>(colors.size());
  info.pColorAttachments = colors.data();
  info.pDepthAttachment = &depth;
  host.vk.vkCmdBeginRendering(commands, &info);
  const VkViewport viewport = {
      0.0f, 0.0f, static_cast<float>(extent.width), static_cast<float>(extent.height), 0.0f, 1.0f};
  const VkRect2D scissor = {{0, 0}, extent};
  host.vk.vkCmdSetViewport(commands, 0, 1, &viewport);
  host.vk.vkCmdSetScissor(commands, 0, 1, &scissor);
}

ObjectData object_data(const SceneState& state, uint32_t object, uint32_t layer) {
  ObjectData data{};
  const glm::mat4 world(glm::transpose(state.world[object]));
  const glm::mat4 previous(glm::transpose(state.previous_world[object]));
  for (int row = 0; row < 3; ++row) {
    data.world[row] = world[row];
    data.previous[row] = previous[row];
  }
  data.material = object;
  data.layer = layer;
  return data;
}

void draw_object(Renderer& renderer, VkCommandBuffer commands, const ProgramLayout& layout,
                 VkShaderStageFlags stages, uint32_t object, const ObjectData& data) {
  const VulkanHost& host = *renderer.host;
  const GpuMesh& mesh = renderer.gpu.meshes[renderer.gpu.mesh_of[object]];
  const VkDeviceSize start = 0;
  host.vk.vkCmdPushConstants(commands, layout.layout.handle, stages, 0, sizeof(data), &data);
  host.vk.vkCmdBindVertexBuffers(commands, 0, 1, &mesh.vertices.buffer, &start);
  host.vk.vkCmdBindIndexBuffer(commands, mesh.indices.buffer, 0, VK_INDEX_TYPE_UINT32);
  host.vk.vkCmdDrawIndexed(commands, mesh.index_count, 1, 0, 0, 0);
}

void record_shadows(Renderer& renderer, VkCommandBuffer commands, const SceneState& state) {
  // Maps stay valid while neither lights nor objects move; changed intensities do not matter.
  if (state.shadow_from_world == renderer.rendered_shadows &&
      state.world == renderer.rendered_world)
    return;
  renderer.rendered_shadows = state.shadow_from_world;
  renderer.rendered_world = state.world;
  const VulkanHost& host = *renderer.host;
  transition(host, commands, renderer.shadow_maps, resting, depth_target);
  for (uint32_t layer = 0; layer < state.shadow_from_world.size(); ++layer) {
    auto depth = attachment(renderer.shadow_maps.layer_views[layer], depth_target.layout);
    depth.clearValue.depthStencil.depth = 1.0f;
    begin_drawing(host, commands, {shadow_map_size, shadow_map_size}, {}, depth);
    host.vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS,
                              renderer.shadow_pipeline.handle);
    host.vk.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS,
                                    renderer.shadow_layout.layout.handle, 0, 1,
                                    &renderer.shadow_set, 0, nullptr);
    for (uint32_t i = 0; i < renderer.scene->objects.size(); ++i)
      if (renderer.scene->objects[i].casts_shadow)
        draw_object(renderer, commands, renderer.shadow_layout, VK_SHADER_STAGE_VERTEX_BIT, i,
                    object_data(state, i, layer));
    host.vk.vkCmdEndRendering(commands);
  }
  transition(host, commands, renderer.shadow_maps, depth_target, resting);
}

void record_gbuffer(Renderer& renderer, VkCommandBuffer commands, const SceneState& state) {
  const VulkanHost& host = *renderer.host;
  std::array<VkRenderingAttachmentInfo, gbuffer_targets.size()> colors;
  for (size_t i = 0; i < colors.size(); ++i) {
    transition(host, commands, renderer[gbuffer_targets[i]], resting, color_target);
    colors[i] = attachment(renderer[gbuffer_targets[i]].view, color_target.layout);
  }
  transition(host, commands, renderer[Target::depth], resting, depth_target);
  auto depth = attachment(renderer[Target::depth].view, depth_target.layout);
  depth.clearValue.depthStencil.depth = renderer.view.reversed_depth ? 0.0f : 1.0f;
  begin_drawing(host, commands, {renderer.view.width, renderer.view.height}, colors, depth);
  host.vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS,
                            renderer.gbuffer_pipeline.handle);
  constexpr VkShaderStageFlags stages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
  for (uint32_t i = 0; i < renderer.scene->objects.size(); ++i) {
    const VkDescriptorSet sets[] = {renderer.gbuffer_set, renderer.gpu.maps_of[i]};
    host.vk.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS,
                                    renderer.gbuffer_layout.layout.handle, 0, 2, sets, 0, nullptr);
    draw_object(renderer, commands, renderer.gbuffer_layout, stages, i, object_data(state, i, 0));
  }
  host.vk.vkCmdEndRendering(commands);
  for (const Target target : gbuffer_targets)
    transition(host, commands, renderer[target], color_target, resting);
  transition(host, commands, renderer[Target::depth], depth_target, resting);
}

void dispatch(Renderer& renderer, VkCommandBuffer commands, const Program& program,
              VkDescriptorSet set) {
  constexpr uint32_t tile = 8; // local size of both kernels
  const VulkanHost& host = *renderer.host;
  host.vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, program.pipeline.handle);
  host.vk.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE,
                                  program.layout.layout.handle, 0, 1, &set, 0, nullptr);
  host.vk.vkCmdDispatch(commands, (renderer.view.width + tile - 1) / tile,
                        (renderer.view.height + tile - 1) / tile, 1);
}

LightData light_data(const Light& light, const SceneState& state, uint32_t first_layer) {
  const glm::dvec3 from = value_at(light.position, state.seconds),
                   direction = direction_of(light, state.seconds);
  const glm::dmat4& view = state.now.view_from_world;
  LightData data{};
  data.position =
      glm::vec4(glm::vec3(view * glm::dvec4(from, 1.0)), static_cast<float>(light.type));
  const double outer = glm::radians(0.5 * light.angle);
  const double inner = glm::radians(std::max(0.0, 0.5 * light.angle - light.penumbra));
  data.direction =
      glm::vec4(glm::vec3(view * glm::dvec4(direction, 0.0)), static_cast<float>(std::cos(outer)));
  data.intensity = glm::vec4(glm::vec3(light.color * value_at(light.intensity, state.seconds)),
                             static_cast<float>(std::cos(inner)));
  data.shadow.x = first_layer == no_layer ? no_shadow : first_layer;
  return data;
}

} // namespace

void set_frame(Renderer& renderer, const SceneState& state, Scattering scattering) {
  const Scene& scene = *renderer.scene;
  const glm::dmat4 clip_from_world = state.now.clip_from_view * state.now.view_from_world;
  FrameData data{};
  data.clip_from_world = glm::mat4(clip_from_world);
  data.clip_from_world_steady =
      glm::mat4(state.now.clip_from_view_steady * state.now.view_from_world);
  data.previous_clip_from_world =
      glm::mat4(state.previous.clip_from_view_steady * state.previous.view_from_world);
  data.view_from_world = glm::mat4(state.now.view_from_world);
  data.view_from_clip = glm::mat4(glm::inverse(state.now.clip_from_view));
  data.sky = glm::vec4(glm::vec3(scene.sky), 0.0f);
  data.ground = glm::vec4(glm::vec3(scene.ground), 0.0f);
  data.background = glm::vec4(glm::vec3(scene.background), 0.0f);
  data.up = glm::vec4(state.now.view_from_world * glm::dvec4(0, 1, 0, 0));
  const glm::vec2 size(renderer.view.width, renderer.view.height);
  data.size = glm::vec4(size, 1.0f / size);
  data.misc =
      glm::vec4(renderer.view.reversed_depth ? 0.0f : 1.0f, static_cast<float>(scene.exposure),
                1.0f / shadow_map_size, scene.camera.orthographic ? 1.0f : 0.0f);
  data.counts = glm::uvec4(static_cast<uint32_t>(scene.lights.size()),
                           static_cast<uint32_t>(scattering), 0u, 0u);
  for (size_t i = 0; i < scene.lights.size(); ++i)
    data.lights[i] = light_data(scene.lights[i], state, state.first_layer[i]);
  const glm::dmat4 world_from_view = glm::inverse(state.now.view_from_world);
  auto* shadows = static_cast<glm::mat4*>(renderer.shadow_buffer.mapped);
  for (size_t i = 0; i < state.shadow_from_world.size(); ++i) {
    data.shadow_from_view[i] = glm::mat4(state.shadow_from_world[i] * world_from_view);
    shadows[i] = glm::mat4(state.shadow_from_world[i]);
  }
  std::memcpy(renderer.frame_buffer.mapped, &data, sizeof(data));
}

void record_new_times(Renderer& renderer, VkCommandBuffer commands) {
  if (renderer.queries.host)
    renderer.host->vk.vkCmdResetQueryPool(commands, renderer.queries.handle, 0, timestamp_count);
}

void record_scene(Renderer& renderer, VkCommandBuffer commands, const SceneState& state) {
  const VulkanHost& host = *renderer.host;
  stamp(renderer, commands, at_start);
  record_shadows(renderer, commands, state);
  stamp(renderer, commands, after_shadows);
  record_gbuffer(renderer, commands, state);
  stamp(renderer, commands, after_gbuffer);
  for (const Target target : lit_targets)
    transition(host, commands, renderer[target], resting, storage_target);
  dispatch(renderer, commands, renderer.lighting, renderer.lighting_set);
  for (const Target target : lit_targets)
    transition(host, commands, renderer[target], storage_target, resting);
  stamp(renderer, commands, after_lighting);
}

void record_composite(Renderer& renderer, VkCommandBuffer commands) {
  const VulkanHost& host = *renderer.host;
  stamp(renderer, commands, at_composite);
  transition(host, commands, renderer[Target::color], resting, storage_target);
  dispatch(renderer, commands, renderer.composite, renderer.composite_set);
  transition(host, commands, renderer[Target::color], storage_target, resting);
  stamp(renderer, commands, at_end);
}

} // namespace demo
