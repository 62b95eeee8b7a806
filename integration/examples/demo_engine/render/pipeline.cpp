#include "integration/examples/demo_engine/render/pipeline.hpp"

#include "integration/examples/demo_engine/geometry/mesh.hpp"

#include <array>
#include <cstddef>

namespace demo {
namespace {

Result<OwnedShader> create_shader(VulkanHost& host, std::span<const uint32_t> code) {
  auto info = vulkan_struct<VkShaderModuleCreateInfo>(VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO);
  info.codeSize = code.size_bytes();
  info.pCode = code.data();
  VkShaderModule shader = VK_NULL_HANDLE;
  const VkResult result = host.vk.vkCreateShaderModule(host.device, &info, nullptr, &shader);
  if (result != VK_SUCCESS) return vulkan_error("vkCreateShaderModule", result);
  return OwnedShader(host, shader);
}

VkPipelineShaderStageCreateInfo stage(VkShaderStageFlagBits flag, VkShaderModule shader) {
  auto info = vulkan_struct<VkPipelineShaderStageCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO);
  info.stage = flag;
  info.module = shader;
  info.pName = "main";
  return info;
}

constexpr std::array vertex_attributes = {
    VkVertexInputAttributeDescription{0, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(Vertex, position)},
    VkVertexInputAttributeDescription{1, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(Vertex, normal)},
    VkVertexInputAttributeDescription{2, 0, VK_FORMAT_R32G32_SFLOAT, offsetof(Vertex, uv)},
    VkVertexInputAttributeDescription{3, 0, VK_FORMAT_R32G32B32A32_SFLOAT,
                                      offsetof(Vertex, tangent)},
    VkVertexInputAttributeDescription{4, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(Vertex, tint)},
    VkVertexInputAttributeDescription{5, 0, VK_FORMAT_R32G32_SFLOAT, offsetof(Vertex, openness)},
};

} // namespace

Result<ProgramLayout> create_layout(VulkanHost& host, const std::vector<std::vector<Binding>>& sets,
                                    uint32_t push_bytes, VkShaderStageFlags push_stages) {
  ProgramLayout layout;
  std::vector<VkDescriptorSetLayout> handles;
  for (const std::vector<Binding>& set : sets) {
    std::vector<VkDescriptorSetLayoutBinding> bindings;
    for (uint32_t i = 0; i < set.size(); ++i)
      bindings.push_back({i, set[i].type, 1, set[i].stages, nullptr});
    auto info = vulkan_struct<VkDescriptorSetLayoutCreateInfo>(
        VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO);
    info.bindingCount = static_cast<uint32_t>(bindings.size());
    info.pBindings = bindings.data();
    VkDescriptorSetLayout handle = VK_NULL_HANDLE;
    const VkResult result =
        host.vk.vkCreateDescriptorSetLayout(host.device, &info, nullptr, &handle);
    if (result != VK_SUCCESS) return vulkan_error("vkCreateDescriptorSetLayout", result);
    layout.sets.emplace_back(host, handle);
    handles.push_back(handle);
  }
  auto info =
      vulkan_struct<VkPipelineLayoutCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO);
  info.setLayoutCount = static_cast<uint32_t>(handles.size());
  info.pSetLayouts = handles.data();
  const VkPushConstantRange push = {push_stages, 0, push_bytes};
  info.pushConstantRangeCount = push_bytes > 0 ? 1 : 0;
  info.pPushConstantRanges = &push;
  VkPipelineLayout handle = VK_NULL_HANDLE;
  const VkResult result = host.vk.vkCreatePipelineLayout(host.device, &info, nullptr, &handle);
  if (result != VK_SUCCESS) return vulkan_error("vkCreatePipelineLayout", result);
  layout.layout = OwnedPipelineLayout(host, handle);
  return layout;
}

Result<Program> create_compute(VulkanHost& host, std::span<const uint32_t> code,
                               const std::vector<std::vector<Binding>>& sets) {
  auto layout = create_layout(host, sets, 0, 0);
  if (!layout) return layout.error();
  auto shader = create_shader(host, code);
  if (!shader) return shader.error();
  auto info =
      vulkan_struct<VkComputePipelineCreateInfo>(VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO);
  info.stage = stage(VK_SHADER_STAGE_COMPUTE_BIT, shader->handle);
  info.layout = layout->layout.handle;
  VkPipeline pipeline = VK_NULL_HANDLE;
  const VkResult result =
      host.vk.vkCreateComputePipelines(host.device, VK_NULL_HANDLE, 1, &info, nullptr, &pipeline);
  if (result != VK_SUCCESS) return vulkan_error("vkCreateComputePipelines", result);
  return Program{layout.take(), OwnedPipeline(host, pipeline)};
}

Result<OwnedPipeline> create_graphics(VulkanHost& host, const GraphicsDesc& desc,
                                      const ProgramLayout& layout) {
  auto vertex = create_shader(host, desc.vertex);
  if (!vertex) return vertex.error();
  std::vector<VkPipelineShaderStageCreateInfo> stages = {
      stage(VK_SHADER_STAGE_VERTEX_BIT, vertex->handle)};
  OwnedShader fragment;
  if (!desc.fragment.empty()) {
    auto made = create_shader(host, desc.fragment);
    if (!made) return made.error();
    fragment = made.take();
    stages.push_back(stage(VK_SHADER_STAGE_FRAGMENT_BIT, fragment.handle));
  }
  const VkVertexInputBindingDescription stream = {0, sizeof(Vertex), VK_VERTEX_INPUT_RATE_VERTEX};
  auto input = vulkan_struct<VkPipelineVertexInputStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO);
  input.vertexBindingDescriptionCount = 1;
  input.pVertexBindingDescriptions = &stream;
  input.vertexAttributeDescriptionCount =
      desc.position_only ? 1 : static_cast<uint32_t>(vertex_attributes.size());
  input.pVertexAttributeDescriptions = vertex_attributes.data();
  auto assembly = vulkan_struct<VkPipelineInputAssemblyStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO);
  assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  auto viewport = vulkan_struct<VkPipelineViewportStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO);
  viewport.viewportCount = 1;
  viewport.scissorCount = 1;
  auto raster = vulkan_struct<VkPipelineRasterizationStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO);
  raster.polygonMode = VK_POLYGON_MODE_FILL;
  raster.cullMode = VK_CULL_MODE_NONE;
  raster.frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE;
  raster.lineWidth = 1.0f;
  raster.depthBiasEnable = desc.depth_bias ? VK_TRUE : VK_FALSE;
  // Units: the smallest step of the depth format, and the slope per texel.
  raster.depthBiasConstantFactor = 2.0f;
  raster.depthBiasSlopeFactor = 2.0f;
  auto samples = vulkan_struct<VkPipelineMultisampleStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO);
  samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
  auto depth = vulkan_struct<VkPipelineDepthStencilStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO);
  depth.depthTestEnable = VK_TRUE;
  depth.depthWriteEnable = VK_TRUE;
  depth.depthCompareOp = desc.compare;
  std::vector<VkPipelineColorBlendAttachmentState> attachments(desc.colors.size());
  for (auto& one : attachments)
    one.colorWriteMask = 0xf;
  auto blend = vulkan_struct<VkPipelineColorBlendStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO);
  blend.attachmentCount = static_cast<uint32_t>(attachments.size());
  blend.pAttachments = attachments.data();
  const VkDynamicState dynamics[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
  auto dynamic = vulkan_struct<VkPipelineDynamicStateCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO);
  dynamic.dynamicStateCount = 2;
  dynamic.pDynamicStates = dynamics;
  auto rendering = vulkan_struct<VkPipelineRenderingCreateInfo>(
      VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO);
  rendering.colorAttachmentCount = static_cast<uint32_t>(desc.colors.size());
  rendering.pColorAttachmentFormats = desc.colors.data();
  rendering.depthAttachmentFormat = desc.depth;
  auto info =
      vulkan_struct<VkGraphicsPipelineCreateInfo>(VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO);
  info.pNext = &rendering;
  info.stageCount = static_cast<uint32_t>(stages.size());
  info.pStages = stages.data();
  info.pVertexInputState = &input;
  info.pInputAssemblyState = &assembly;
  info.pViewportState = &viewport;
  info.pRasterizationState = &raster;
  info.pMultisampleState = &samples;
  info.pDepthStencilState = &depth;
  info.pColorBlendState = &blend;
  info.pDynamicState = &dynamic;
  info.layout = layout.layout.handle;
  VkPipeline pipeline = VK_NULL_HANDLE;
  const VkResult result =
      host.vk.vkCreateGraphicsPipelines(host.device, VK_NULL_HANDLE, 1, &info, nullptr, &pipeline);
  if (result != VK_SUCCESS) return vulkan_error("vkCreateGraphicsPipelines", result);
  return OwnedPipeline(host, pipeline);
}

Result<OwnedSampler> create_sampler(VulkanHost& host, Sampling sampling) {
  auto info = vulkan_struct<VkSamplerCreateInfo>(VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO);
  const bool nearest = sampling == Sampling::nearest, compare = sampling == Sampling::compare;
  info.magFilter = nearest ? VK_FILTER_NEAREST : VK_FILTER_LINEAR;
  info.minFilter = info.magFilter;
  info.mipmapMode = nearest ? VK_SAMPLER_MIPMAP_MODE_NEAREST : VK_SAMPLER_MIPMAP_MODE_LINEAR;
  const VkSamplerAddressMode address = sampling == Sampling::smooth
                                           ? VK_SAMPLER_ADDRESS_MODE_REPEAT
                                           : VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
  info.addressModeU = address;
  info.addressModeV = address;
  info.addressModeW = address;
  info.maxLod = VK_LOD_CLAMP_NONE;
  info.compareEnable = compare ? VK_TRUE : VK_FALSE;
  info.compareOp = VK_COMPARE_OP_LESS_OR_EQUAL;
  VkSampler sampler = VK_NULL_HANDLE;
  const VkResult result = host.vk.vkCreateSampler(host.device, &info, nullptr, &sampler);
  if (result != VK_SUCCESS) return vulkan_error("vkCreateSampler", result);
  return OwnedSampler(host, sampler);
}

Result<OwnedDescriptorPool> create_descriptor_pool(VulkanHost& host, uint32_t sets) {
  // No set of the renderer has more than eight descriptors of a type.
  constexpr uint32_t each = 8;
  const VkDescriptorPoolSize sizes[] = {{VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, sets * each},
                                        {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, sets * each},
                                        {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, sets * each},
                                        {VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, sets * each}};
  auto info =
      vulkan_struct<VkDescriptorPoolCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO);
  info.maxSets = sets;
  info.poolSizeCount = 4;
  info.pPoolSizes = sizes;
  VkDescriptorPool pool = VK_NULL_HANDLE;
  const VkResult result = host.vk.vkCreateDescriptorPool(host.device, &info, nullptr, &pool);
  if (result != VK_SUCCESS) return vulkan_error("vkCreateDescriptorPool", result);
  return OwnedDescriptorPool(host, pool);
}

Result<VkDescriptorSet> allocate_set(VulkanHost& host, const OwnedDescriptorPool& pool,
                                     const OwnedSetLayout& layout) {
  auto info =
      vulkan_struct<VkDescriptorSetAllocateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO);
  info.descriptorPool = pool.handle;
  info.descriptorSetCount = 1;
  info.pSetLayouts = &layout.handle;
  VkDescriptorSet set = VK_NULL_HANDLE;
  const VkResult result = host.vk.vkAllocateDescriptorSets(host.device, &info, &set);
  if (result != VK_SUCCESS) return vulkan_error("vkAllocateDescriptorSets", result);
  return set;
}

void write_buffer(VulkanHost& host, VkDescriptorSet set, uint32_t binding, VkDescriptorType type,
                  const Buffer& buffer) {
  const VkDescriptorBufferInfo info = {buffer.buffer, 0, VK_WHOLE_SIZE};
  auto write = vulkan_struct<VkWriteDescriptorSet>(VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET);
  write.dstSet = set;
  write.dstBinding = binding;
  write.descriptorCount = 1;
  write.descriptorType = type;
  write.pBufferInfo = &info;
  host.vk.vkUpdateDescriptorSets(host.device, 1, &write, 0, nullptr);
}

void write_image(VulkanHost& host, VkDescriptorSet set, uint32_t binding, VkDescriptorType type,
                 VkImageView view, VkImageLayout layout, VkSampler sampler) {
  const VkDescriptorImageInfo info = {sampler, view, layout};
  auto write = vulkan_struct<VkWriteDescriptorSet>(VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET);
  write.dstSet = set;
  write.dstBinding = binding;
  write.descriptorCount = 1;
  write.descriptorType = type;
  write.pImageInfo = &info;
  host.vk.vkUpdateDescriptorSets(host.device, 1, &write, 0, nullptr);
}

} // namespace demo
