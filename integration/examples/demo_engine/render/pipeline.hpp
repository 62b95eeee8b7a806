#pragma once
// Helpers for pipelines, their layouts and descriptor sets.

#include "integration/examples/demo_engine/render/owned.hpp"
#include "integration/examples/demo_engine/vulkan_image.hpp"

#include <span>
#include <vector>

namespace demo {

struct Binding {
  VkDescriptorType type;
  VkShaderStageFlags stages;
};

// Set layouts by index; bindings by index.
struct ProgramLayout {
  std::vector<OwnedSetLayout> sets;
  OwnedPipelineLayout layout;
};

struct Program {
  ProgramLayout layout;
  OwnedPipeline pipeline;
};

struct GraphicsDesc {
  std::span<const uint32_t> vertex, fragment; // SPIR-V; empty fragment for depth only
  std::vector<VkFormat> colors;
  VkFormat depth = VK_FORMAT_D32_SFLOAT;
  VkCompareOp compare = VK_COMPARE_OP_LESS;
  bool depth_bias = false;
  bool position_only = false;
};

// Errors: environment.
Result<ProgramLayout> create_layout(VulkanHost& host, const std::vector<std::vector<Binding>>& sets,
                                    uint32_t push_bytes, VkShaderStageFlags push_stages);
Result<Program> create_compute(VulkanHost& host, std::span<const uint32_t> code,
                               const std::vector<std::vector<Binding>>& sets);
// Creates a pipeline. Vertices as in geometry/mesh.hpp; viewport and scissor are dynamic; no
// culling.
Result<OwnedPipeline> create_graphics(VulkanHost& host, const GraphicsDesc& desc,
                                      const ProgramLayout& layout);

enum class Sampling : uint8_t {
  nearest, // for images that are read texel by texel
  smooth,  // trilinear, repeating
  compare, // less or equal, bilinear
};
Result<OwnedSampler> create_sampler(VulkanHost& host, Sampling sampling);
Result<OwnedDescriptorPool> create_descriptor_pool(VulkanHost& host, uint32_t sets);
Result<VkDescriptorSet> allocate_set(VulkanHost& host, const OwnedDescriptorPool& pool,
                                     const OwnedSetLayout& layout);

void write_buffer(VulkanHost& host, VkDescriptorSet set, uint32_t binding, VkDescriptorType type,
                  const Buffer& buffer);
void write_image(VulkanHost& host, VkDescriptorSet set, uint32_t binding, VkDescriptorType type,
                 VkImageView view, VkImageLayout layout, VkSampler sampler);

} // namespace demo
