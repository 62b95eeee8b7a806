#pragma once
// The deferred renderer: shadow maps, G-buffer, lighting, and the composite, which runs after
// subsurface scattering.

#include "integration/examples/demo_engine/render/frame_data.hpp"
#include "integration/examples/demo_engine/render/ray_scene.hpp"
#include "integration/examples/demo_engine/render/scene_gpu.hpp"
#include "integration/examples/demo_engine/scene/scene_state.hpp"

#include <array>
#include <memory>
#include <string_view>
#include <vector>

namespace demo {

// Images of one frame. Graphs bind them by these names; "" is not available to graphs.
enum class Target : uint8_t {
  depth,    // device depth
  normal,   // view space, geometric
  shading,  // view space, with normal map
  albedo,   // linear when read
  material, // profile id, 0 = none
  finish,   // roughness, reflectance, openness, emission
  velocity, // pixels, now - previous
  lighting, // diffuse light before albedo
  specular,
  scattered, // light before albedo, if the graph exports it
  color,
  // Thickness in metres for the light with the most transmission from behind.
  thickness,
  back_lighting, // irradiance of this light on the far side
  sampling,      // the graph's `sampling` output, if requested
  tile_class,    // the graph's `tile_class` output, if requested
};
inline constexpr size_t target_count = 15;

struct TargetInfo {
  std::string_view slot;
  VkFormat format;
  VkImageUsageFlags usage;
};
const TargetInfo& target_info(Target target);

inline constexpr ImageState storage_target = {VK_IMAGE_LAYOUT_GENERAL,
                                              VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                                              VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT};
// State of each target between the passes of this engine and the graph.
inline constexpr ImageState resting = {VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                                       VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                                       VK_ACCESS_2_SHADER_SAMPLED_READ_BIT};

struct RendererDesc {
  ViewDesc view;
  std::array<VkImageUsageFlags, target_count> more_usage{}; // usage that the graph needs
};

enum Timestamp : uint32_t {
  at_start,
  after_shadows,
  after_gbuffer,
  after_lighting,
  at_composite,
  at_end
};
inline constexpr uint32_t timestamp_count = 6;

// Belongs to one thread; must be destroyed before its host.
struct Renderer {
  VulkanHost* host = nullptr;
  const Scene* scene = nullptr;
  ViewDesc view;
  std::array<Image, target_count> targets;
  Image shadow_maps;
  Buffer frame_buffer, shadow_buffer; // frame_buffer: FrameData; shadow_buffer: shadow_from_world
  OwnedSampler texel_sampler, map_sampler, shadow_sampler;
  OwnedDescriptorPool pool;
  ProgramLayout shadow_layout, gbuffer_layout;
  OwnedPipeline shadow_pipeline, gbuffer_pipeline;
  Program lighting, composite;
  VkDescriptorSet shadow_set = VK_NULL_HANDLE, gbuffer_set = VK_NULL_HANDLE;
  VkDescriptorSet lighting_set = VK_NULL_HANDLE, composite_set = VK_NULL_HANDLE;
  OwnedQueryPool queries;
  SceneGpu gpu;
  std::unique_ptr<RayScene> rays; // null until requested
  // state for which the shadow maps were rendered
  std::vector<glm::dmat4> rendered_shadows, rendered_world;

  const Image& operator[](Target target) const { return targets[static_cast<size_t>(target)]; }
};

// `scene` must outlive the renderer. Errors: usage, environment.
Result<std::unique_ptr<Renderer>> create_renderer(VulkanHost& host, const Scene& scene,
                                                  const Model& model, const RendererDesc& desc);

// Fills the frame's constants. The device must be idle.
void set_frame(Renderer& renderer, const SceneState& state, Scattering scattering);
// Resets the timestamps of the previous frame; call this at the beginning of each frame.
void record_new_times(Renderer& renderer, VkCommandBuffer commands);
// Records shadow maps (those that changed), G-buffer, lighting. All targets are in the resting
// state afterwards.
void record_scene(Renderer& renderer, VkCommandBuffer commands, const SceneState& state);
// Records the composite, which writes `color`. All targets are in the resting state before and
// after.
void record_composite(Renderer& renderer, VkCommandBuffer commands);
// Returns milliseconds between two timestamps of the last frame; 0 without timestamps. The device
// must be idle.
double elapsed_ms(Renderer& renderer, Timestamp from, Timestamp to);

} // namespace demo
