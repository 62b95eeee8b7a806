// Creates and destroys objects, binds and maps memory.
#include "framegraph/model/align_up.hpp"
#include "integration/tools/null_device/state.hpp"

#include <iterator>

namespace dermis {
namespace {

// bytes, as on desktop devices
constexpr uint64_t image_alignment = 65536, buffer_alignment = 256;
constexpr uint64_t largest_texel = 16; // bytes: four 32-bit channels

// Upper bound: the largest texel, and a mip chain as a third more.
VkMemoryRequirements needs_of(const VkImageCreateInfo& info) {
  const uint64_t texels = uint64_t{info.extent.width} * info.extent.height * info.arrayLayers;
  const uint64_t bytes = texels * largest_texel * (info.mipLevels > 1 ? 4 : 3) / 3;
  return {align_up(bytes, image_alignment), image_alignment, 0};
}

VkMemoryRequirements needs_of(const VkBufferCreateInfo& info) {
  return {align_up(info.size, buffer_alignment), buffer_alignment, 0};
}

template <class Info>
VkMemoryRequirements needs_on(const NullDeviceState& state, const Info& info) {
  VkMemoryRequirements needs = needs_of(info);
  needs.memoryTypeBits = memory_types(state);
  return needs;
}

template <class Info, class Handle>
VKAPI_ATTR VkResult VKAPI_CALL create(VkDevice device, const Info* info,
                                      const VkAllocationCallbacks*, Handle* handle) {
  NullDeviceState& state = state_of(device);
  if (const VkResult result = count_creation(state); result != VK_SUCCESS) return result;
  if constexpr (requires { info->memoryTypeIndex; })
    if (state.full_bar && info->memoryTypeIndex == bar_memory_type)
      return VK_ERROR_OUT_OF_DEVICE_MEMORY;
  uint64_t bytes = 0;
  if constexpr (requires { info->allocationSize; }) bytes = info->allocationSize;
  NullObject* object = add_object(state, bytes);
  if constexpr (requires { needs_of(*info); }) object->needs = needs_on(state, *info);
  if constexpr (requires { info->memoryTypeIndex; })
    object->host_visible = !state.discrete || info->memoryTypeIndex == host_memory_type;
  *handle = reinterpret_cast<Handle>(object);
  return VK_SUCCESS;
}

template <class Handle>
VKAPI_ATTR void VKAPI_CALL destroy(VkDevice device, Handle handle, const VkAllocationCallbacks*) {
  remove_object(state_of(device), reinterpret_cast<NullObject*>(handle));
}

VKAPI_ATTR VkResult VKAPI_CALL create_pipelines(VkDevice device, VkPipelineCache, uint32_t count,
                                                const VkComputePipelineCreateInfo*,
                                                const VkAllocationCallbacks*,
                                                VkPipeline* pipelines) {
  NullDeviceState& state = state_of(device);
  const VkResult result = count_creation(state);
  if (result == VK_SUCCESS) state.pipelines += count;
  for (uint32_t i = 0; i < count; ++i)
    pipelines[i] =
        result == VK_SUCCESS ? reinterpret_cast<VkPipeline>(add_object(state)) : VK_NULL_HANDLE;
  return result;
}

// Set handles equal the handle of the pool, which owns the sets.
VKAPI_ATTR VkResult VKAPI_CALL allocate_sets(VkDevice device,
                                             const VkDescriptorSetAllocateInfo* info,
                                             VkDescriptorSet* sets) {
  if (const VkResult result = count_creation(state_of(device)); result != VK_SUCCESS) return result;
  for (uint32_t i = 0; i < info->descriptorSetCount; ++i)
    sets[i] = reinterpret_cast<VkDescriptorSet>(info->descriptorPool);
  return VK_SUCCESS;
}

VKAPI_ATTR void VKAPI_CALL update_sets(VkDevice device, uint32_t count,
                                       const VkWriteDescriptorSet* writes, uint32_t,
                                       const VkCopyDescriptorSet*) {
  for (uint32_t i = 0; i < count; ++i)
    state_of(device).descriptor_writes += writes[i].descriptorCount;
}

VKAPI_ATTR void VKAPI_CALL image_requirements(VkDevice, VkImage image,
                                              VkMemoryRequirements* needs) {
  *needs = object_of(image).needs;
}

VKAPI_ATTR void VKAPI_CALL buffer_requirements(VkDevice, VkBuffer buffer,
                                               VkMemoryRequirements* needs) {
  *needs = object_of(buffer).needs;
}

VKAPI_ATTR void VKAPI_CALL device_image_requirements(VkDevice device,
                                                     const VkDeviceImageMemoryRequirements* query,
                                                     VkMemoryRequirements2* needs) {
  needs->memoryRequirements = needs_on(state_of(device), *query->pCreateInfo);
}

VKAPI_ATTR void VKAPI_CALL device_buffer_requirements(VkDevice device,
                                                      const VkDeviceBufferMemoryRequirements* query,
                                                      VkMemoryRequirements2* needs) {
  needs->memoryRequirements = needs_on(state_of(device), *query->pCreateInfo);
}

template <class Info> VKAPI_ATTR VkResult VKAPI_CALL bind(VkDevice device, uint32_t, const Info*) {
  return count_creation(state_of(device));
}

VKAPI_ATTR VkResult VKAPI_CALL map_memory(VkDevice device, VkDeviceMemory memory,
                                          VkDeviceSize offset, VkDeviceSize, VkMemoryMapFlags,
                                          void** data) {
  if (const VkResult result = count_creation(state_of(device)); result != VK_SUCCESS) return result;
  NullObject& object = object_of(memory);
  if (!object.host_visible) return VK_ERROR_MEMORY_MAP_FAILED;
  if (!object.contents) object.contents = std::make_unique<std::byte[]>(object.bytes);
  *data = object.contents.get() + offset;
  return VK_SUCCESS;
}

template <class Function> NullEntry create_entry(const char* name) {
  const Function function = &create;
  return entry(name, function);
}

template <class Function> NullEntry destroy_entry(const char* name) {
  const Function function = &destroy;
  return entry(name, function);
}

} // namespace

PFN_vkVoidFunction object_function(const char* name) {
  static const NullEntry entries[] = {
      create_entry<PFN_vkCreateImage>("vkCreateImage"),
      destroy_entry<PFN_vkDestroyImage>("vkDestroyImage"),
      create_entry<PFN_vkCreateImageView>("vkCreateImageView"),
      destroy_entry<PFN_vkDestroyImageView>("vkDestroyImageView"),
      create_entry<PFN_vkCreateBuffer>("vkCreateBuffer"),
      destroy_entry<PFN_vkDestroyBuffer>("vkDestroyBuffer"),
      create_entry<PFN_vkAllocateMemory>("vkAllocateMemory"),
      destroy_entry<PFN_vkFreeMemory>("vkFreeMemory"),
      create_entry<PFN_vkCreateSampler>("vkCreateSampler"),
      destroy_entry<PFN_vkDestroySampler>("vkDestroySampler"),
      create_entry<PFN_vkCreateDescriptorSetLayout>("vkCreateDescriptorSetLayout"),
      destroy_entry<PFN_vkDestroyDescriptorSetLayout>("vkDestroyDescriptorSetLayout"),
      create_entry<PFN_vkCreateDescriptorPool>("vkCreateDescriptorPool"),
      destroy_entry<PFN_vkDestroyDescriptorPool>("vkDestroyDescriptorPool"),
      create_entry<PFN_vkCreatePipelineLayout>("vkCreatePipelineLayout"),
      destroy_entry<PFN_vkDestroyPipelineLayout>("vkDestroyPipelineLayout"),
      create_entry<PFN_vkCreateShaderModule>("vkCreateShaderModule"),
      destroy_entry<PFN_vkDestroyShaderModule>("vkDestroyShaderModule"),
      destroy_entry<PFN_vkDestroyPipeline>("vkDestroyPipeline"),
      create_entry<PFN_vkCreateQueryPool>("vkCreateQueryPool"),
      destroy_entry<PFN_vkDestroyQueryPool>("vkDestroyQueryPool"),
      entry("vkCreateComputePipelines", &create_pipelines),
      entry("vkAllocateDescriptorSets", &allocate_sets),
      entry("vkUpdateDescriptorSets", &update_sets),
      entry("vkGetImageMemoryRequirements", &image_requirements),
      entry("vkGetBufferMemoryRequirements", &buffer_requirements),
      entry("vkGetDeviceImageMemoryRequirements", &device_image_requirements),
      entry("vkGetDeviceBufferMemoryRequirements", &device_buffer_requirements),
      entry("vkBindImageMemory2", &bind<VkBindImageMemoryInfo>),
      entry("vkBindBufferMemory2", &bind<VkBindBufferMemoryInfo>),
      entry("vkMapMemory", &map_memory),
  };
  return find_entry(entries, std::size(entries), name);
}

} // namespace dermis
