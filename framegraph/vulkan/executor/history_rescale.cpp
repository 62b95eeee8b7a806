// Rescales histories of another size. A compute kernel copies the nearest texels, so that a queue
// family without graphics can resize a view.
#include "framegraph/vulkan/create_infos.hpp"
#include "framegraph/vulkan/executor/state.hpp"
#include "framegraph/vulkan/kernel_store.hpp"

#include "rescale_history_float.spv.h"
#include "rescale_history_unsigned.spv.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>

namespace dermis::vulkan {
namespace {

constexpr DispatchRule rescale_dispatch{.domain = DispatchRule::Domain::written_image};

struct RescalePush {
  std::array<uint32_t, 2> source_size, target_size;
  uint32_t mip;
};

struct RescaleCode {
  PassTypeId type; // in a KernelStore; above the ids of all registered pass types
  const char* name;
  std::span<const uint32_t> spirv;
};

RescaleCode rescale_code(bool unsigned_components) {
  if (unsigned_components)
    return {PassTypeId{PassTypeId::none - 1}, "rescale_history_unsigned",
            rescale_history_unsigned_spirv};
  return {PassTypeId{PassTypeId::none - 2}, "rescale_history_float", rescale_history_float_spirv};
}

bool has_format_features(const Device& device, Format format) {
  VkFormatProperties2 properties{};
  properties.sType = VK_STRUCTURE_TYPE_FORMAT_PROPERTIES_2;
  device.vk.vkGetPhysicalDeviceFormatProperties2(device.physical, vk_format(format), &properties);
  constexpr VkFormatFeatureFlags both =
      VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT | VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT;
  return (properties.formatProperties.optimalTilingFeatures & both) == both;
}

Error create_rescale_layouts(const Device& device, Kernel& kernel) {
  constexpr std::array<VkDescriptorSetLayoutBinding, 2> bindings{{
      {0, VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr},
      {1, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr},
  }};
  VkDescriptorSetLayoutCreateInfo set{};
  set.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO;
  set.bindingCount = static_cast<uint32_t>(bindings.size());
  set.pBindings = bindings.data();
  VkResult result = device.vk.vkCreateDescriptorSetLayout(device.device, &set, device.allocator,
                                                          &kernel.set_layout);
  if (result != VK_SUCCESS) {
    kernel.set_layout = VK_NULL_HANDLE;
    return call_error(result, "vkCreateDescriptorSetLayout", "rescaled histories");
  }
  const VkPushConstantRange range{VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof(RescalePush)};
  VkPipelineLayoutCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
  info.setLayoutCount = 1;
  info.pSetLayouts = &kernel.set_layout;
  info.pushConstantRangeCount = 1;
  info.pPushConstantRanges = &range;
  result = device.vk.vkCreatePipelineLayout(device.device, &info, device.allocator, &kernel.layout);
  if (result != VK_SUCCESS) kernel.layout = VK_NULL_HANDLE;
  return call_error(result, "vkCreatePipelineLayout", "rescaled histories");
}

Error find_rescale_pipeline(State& state, const ExecutorInput& input, bool unsigned_components) {
  std::shared_ptr<const Pipeline>& stored = state.rescaling.pipelines[unsigned_components ? 1 : 0];
  if (stored != nullptr) return {};
  const RescaleCode code = rescale_code(unsigned_components);
  if (input.kernel_store != nullptr) stored = input.kernel_store->find(code.type, 0, {});
  if (stored != nullptr) return {};
  const auto kernel = std::make_shared<Kernel>(*state.device);
  kernel->type = code.type;
  kernel->push_bytes = sizeof(RescalePush);
  if (Error error = create_rescale_layouts(*state.device, *kernel)) return error;
  const auto added = std::make_shared<Pipeline>(kernel);
  if (Error error = create_pipeline(*state.device, code.name, code.name, code.spirv,
                                    {input.pipeline_cache}, *added))
    return error;
  stored = added;
  if (input.kernel_store != nullptr) input.kernel_store->add(stored);
  return {};
}

Error create_array_view(State& state, const PlanResource& resource, VkImage image,
                        uint32_t first_mip, uint32_t mips, const std::string& name) {
  VkImageViewCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO;
  info.image = image;
  info.viewType = VK_IMAGE_VIEW_TYPE_2D_ARRAY;
  info.format = vk_format(resource.format);
  info.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, first_mip, mips, 0, resource.layers};
  VkImageView& view = state.rescaling.views.emplace_back(VK_NULL_HANDLE);
  const VkResult result = state.device->vk.vkCreateImageView(state.device->device, &info,
                                                             state.device->allocator, &view);
  if (result != VK_SUCCESS) view = VK_NULL_HANDLE;
  return call_error(result, "vkCreateImageView", name);
}

// Creates the views of each instance: all mips to read, then each mip to write.
Error create_rescale_views(State& state, const PlanResource& resource, HistoryRecord& history) {
  history.first_rescale_view = static_cast<uint32_t>(state.rescaling.views.size());
  for (uint32_t i = 0; i < resource.instance_count; ++i) {
    const VkImage image = state.instances[resource.first_instance + i].image;
    if (Error error = create_array_view(state, resource, image, 0, resource.mips, history.name))
      return error;
    for (uint32_t mip = 0; mip < resource.mips; ++mip)
      if (Error error = create_array_view(state, resource, image, mip, 1, history.name))
        return error;
  }
  return {};
}

Error create_rescale_sets(State& state, const std::vector<VkDescriptorSetLayout>& layouts) {
  const Device& device = *state.device;
  Rescaling& rescaling = state.rescaling;
  const auto count = static_cast<uint32_t>(layouts.size());
  const std::array<VkDescriptorPoolSize, 2> sizes{
      {{VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE, count}, {VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, count}}};
  VkDescriptorPoolCreateInfo pool{};
  pool.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
  pool.maxSets = count;
  pool.poolSizeCount = static_cast<uint32_t>(sizes.size());
  pool.pPoolSizes = sizes.data();
  VkResult result =
      device.vk.vkCreateDescriptorPool(device.device, &pool, device.allocator, &rescaling.pool);
  if (result != VK_SUCCESS) {
    rescaling.pool = VK_NULL_HANDLE;
    return call_error(result, "vkCreateDescriptorPool", "rescaled histories");
  }
  rescaling.sets.assign(count, VK_NULL_HANDLE);
  VkDescriptorSetAllocateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO;
  info.descriptorPool = rescaling.pool;
  info.descriptorSetCount = count;
  info.pSetLayouts = layouts.data();
  result = device.vk.vkAllocateDescriptorSets(device.device, &info, rescaling.sets.data());
  return call_error(result, "vkAllocateDescriptorSets", "rescaled histories");
}

void write_rescale_set(const Device& device, VkDescriptorSet set, VkImageView source,
                       VkImageView target) {
  const std::array<VkDescriptorImageInfo, 2> images{
      {{VK_NULL_HANDLE, source, VK_IMAGE_LAYOUT_GENERAL},
       {VK_NULL_HANDLE, target, VK_IMAGE_LAYOUT_GENERAL}}};
  std::array<VkWriteDescriptorSet, 2> writes{};
  for (uint32_t i = 0; i < writes.size(); ++i) {
    writes[i].sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
    writes[i].dstSet = set;
    writes[i].dstBinding = i;
    writes[i].descriptorCount = 1;
    writes[i].descriptorType =
        i == 0 ? VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE : VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
    writes[i].pImageInfo = &images[i];
  }
  device.vk.vkUpdateDescriptorSets(device.device, static_cast<uint32_t>(writes.size()),
                                   writes.data(), 0, nullptr);
}

uint32_t rescale_view(const HistoryRecord& history, const PlanResource& resource,
                      uint32_t instance) {
  return history.first_rescale_view + (instance - resource.first_instance) * (1 + resource.mips);
}

std::array<uint32_t, 2> mip_size(const PlanResource& resource, uint32_t mip) {
  return {std::max(resource.width >> mip, 1u), std::max(resource.height >> mip, 1u)};
}

} // namespace

bool can_rescale(const Device& device, const PlanResource& resource,
                 const HistoryDeclaration& declaration) noexcept {
  constexpr uint32_t both = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_STORAGE_BIT;
  return declaration.on_resize == HistoryDeclaration::OnResize::rescale &&
         resource.type == ResourceType::image && resource.first_instance != no_instance &&
         (resource.vk_usage & both) == both && has_format_features(device, resource.format);
}

Error create_rescaling(State& state, const ExecutorInput& input) {
  std::vector<VkDescriptorSetLayout> layouts; // of one frame slot
  for (size_t h = 0; h < state.histories.size(); ++h) {
    HistoryRecord& history = state.histories[h];
    if (!history.scales) continue;
    const PlanResource& resource = state.plan.resources[state.plan.histories[h].resource];
    const bool unsigned_components = has_unsigned_components(resource.format);
    if (Error error = find_rescale_pipeline(state, input, unsigned_components)) return error;
    if (Error error = create_rescale_views(state, resource, history)) return error;
    history.first_rescale_set = static_cast<uint32_t>(layouts.size());
    layouts.insert(layouts.end(), size_t{state.plan.histories[h].frames} * resource.mips,
                   state.rescaling.pipelines[unsigned_components ? 1 : 0]->kernel->set_layout);
  }
  state.rescaling.sets_per_slot = static_cast<uint32_t>(layouts.size());
  if (layouts.empty()) return {};
  std::vector<VkDescriptorSetLayout> of_all_slots;
  for (uint32_t slot = 0; slot < state.frames_in_flight; ++slot)
    of_all_slots.insert(of_all_slots.end(), layouts.begin(), layouts.end());
  return create_rescale_sets(state, of_all_slots);
}

void destroy_rescaling(State& state) {
  const Device& device = *state.device;
  device.vk.vkDestroyDescriptorPool(device.device, state.rescaling.pool, device.allocator);
  for (const VkImageView view : state.rescaling.views)
    device.vk.vkDestroyImageView(device.device, view, device.allocator);
}

void record_rescaling(State& to, const State& from, VkCommandBuffer commands,
                      const RescaledHistory& which) noexcept {
  const FunctionTable& vk = *to.commands;
  const HistoryRecord &target = to.histories[which.history],
                      &source = from.histories[which.source_history];
  const PlanResource& new_size = to.plan.resources[to.plan.histories[which.history].resource];
  const PlanResource& old_size =
      from.plan.resources[from.plan.histories[which.source_history].resource];
  const uint32_t source_view =
      rescale_view(source, old_size, instance_of(from, old_size, which.frames_back));
  const uint32_t target_view =
      rescale_view(target, new_size, instance_of(to, new_size, which.frames_back));
  const Pipeline& pipeline =
      *to.rescaling.pipelines[has_unsigned_components(new_size.format) ? 1 : 0];
  const Kernel& kernel = *pipeline.kernel;
  vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline.handle);
  for (uint32_t mip = 0; mip < new_size.mips; ++mip) {
    const VkDescriptorSet set =
        to.rescaling.sets[size_t{which.frame_slot} * to.rescaling.sets_per_slot +
                          target.first_rescale_set + (which.frames_back - 1) * new_size.mips + mip];
    write_rescale_set(*to.device, set, from.rescaling.views[source_view],
                      to.rescaling.views[target_view + 1 + mip]);
    const RescalePush push{mip_size(old_size, mip), mip_size(new_size, mip), mip};
    vk.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, kernel.layout, 0, 1, &set,
                               0, nullptr);
    vk.vkCmdPushConstants(commands, kernel.layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof push,
                          &push);
    const GroupCount groups =
        group_count(rescale_dispatch, push.target_size[0], push.target_size[1]);
    vk.vkCmdDispatch(commands, static_cast<uint32_t>(groups.x), static_cast<uint32_t>(groups.y),
                     new_size.layers);
  }
}

} // namespace dermis::vulkan
