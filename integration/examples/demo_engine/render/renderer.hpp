#pragma once
// The deferred renderer: shadow maps, G-buffer, lighting, and, after whatever happens to the light under the
// skin, the composite.

#include "integration/examples/demo_engine/render/frame_data.hpp"
#include "integration/examples/demo_engine/render/ray_scene.hpp"
#include "integration/examples/demo_engine/render/scene_gpu.hpp"
#include "integration/examples/demo_engine/scene/scene_state.hpp"

#include <array>
#include <memory>
#include <string_view>
#include <vector>

namespace demo {

// Images of one frame. The names are those that graphs bind them by; "" is not for graphs.
enum class Target : uint8_t {
  depth,    // device depth
  normal,   // view space, geometric
  shading,  // view space, with bumps
  albedo,   // linear when read
  material, // profile id, 0 = none
  finish,   // roughness, reflectance, openness, emission
  velocity, // pixels, now - previous
  lighting, // diffuse light before albedo
  specular,
  scattered, // light before albedo, if the graph hands it out
  color,
  thickness,     // metres, of the light that brings most through from behind
  back_lighting, // its irradiance on the far side
  sampling,      // what the graph says of its samples, if it is asked to
  skips,         // the same of what it left out
};
inline constexpr size_t target_count = 15;

struct TargetInfo {
  std::string_view slot;
  VkFormat format;
  VkImageUsageFlags usage;
};
const TargetInfo& target_info(Target target);

inline constexpr ImageState storage_target = {VK_IMAGE_LAYOUT_GENERAL, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                                              VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT};
// Between the passes of this engine and the graph each target rests in this state.
inline constexpr ImageState resting = {VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                                       VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                                       VK_ACCESS_2_SHADER_SAMPLED_READ_BIT};

struct RendererDesc {
  ViewDesc view;
  std::array<VkImageUsageFlags, target_count> more_usage{}; // what the graph needs
};

enum Timestamp : uint32_t { at_start, after_shadows, after_gbuffer, after_lighting, at_composite, at_end };
inline constexpr uint32_t timestamp_count = 6;

// Belongs to one thread; dies before its host.
struct Renderer {
  VulkanHost* host = nullptr;
  const Scene* scene = nullptr;
  ViewDesc view;
  std::array<Image, target_count> targets;
  Image shadow_maps;
  Buffer frame_buffer, shadow_buffer; // FrameData; shadow_from_world
  OwnedSampler texel_sampler, map_sampler, shadow_sampler;
  OwnedDescriptorPool pool;
  ProgramLayout shadow_layout, gbuffer_layout;
  OwnedPipeline shadow_pipeline, gbuffer_pipeline;
  Program lighting, composite;
  VkDescriptorSet shadow_set = VK_NULL_HANDLE, gbuffer_set = VK_NULL_HANDLE;
  VkDescriptorSet lighting_set = VK_NULL_HANDLE, composite_set = VK_NULL_HANDLE;
  OwnedQueryPool queries;
  SceneGpu gpu;
  std::unique_ptr<RayScene> rays;                        // null: not asked for
  std::vector<glm::dmat4> rendered_shadows, drawn_world; // what the shadow maps hold

  const Image& operator[](Target target) const { return targets[static_cast<size_t>(target)]; }
};

// `scene` must outlive the renderer. Errors: usage, environment.
Result<std::unique_ptr<Renderer>> create_renderer(VulkanHost& host, const Scene& scene, const Model& model,
                                                  const RendererDesc& desc);

// Fills the frame's constants; the device must be idle.
void set_frame(Renderer& renderer, const SceneState& state, Scattering scattering);
// Forgets the timestamps of the frame before; at the beginning of each frame.
void record_new_times(Renderer& renderer, VkCommandBuffer commands);
// Shadow maps (those that changed), G-buffer, lighting. Afterwards all targets rest.
void record_scene(Renderer& renderer, VkCommandBuffer commands, const SceneState& state);
// Writes `color` from the others. All targets rest before and after.
void record_composite(Renderer& renderer, VkCommandBuffer commands);
// Milliseconds between two timestamps of the last frame; 0 without them. The device must be idle.
double elapsed_ms(Renderer& renderer, Timestamp from, Timestamp to);

} // namespace demo
