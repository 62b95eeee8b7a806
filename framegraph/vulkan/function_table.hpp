#pragma once
// Holds every Vulkan function the library calls, resolved once per device through the host's
// vkGetInstanceProcAddr. A plain struct, so that tests can replace single entries.

#include <string>
#include <vector>
#include <vulkan/vulkan_core.h>

// clang-format off
#define DERMIS_INSTANCE_FUNCTIONS(X) \
  X(vkGetDeviceProcAddr) X(vkGetPhysicalDeviceProperties) X(vkGetPhysicalDeviceMemoryProperties) \
  X(vkGetPhysicalDeviceQueueFamilyProperties) X(vkGetPhysicalDeviceFormatProperties2) \
  X(vkGetPhysicalDeviceImageFormatProperties2)
#define DERMIS_DEVICE_FUNCTIONS(X) \
  X(vkGetDeviceImageMemoryRequirements) X(vkGetDeviceBufferMemoryRequirements) \
  X(vkCreateImage) X(vkDestroyImage) X(vkCreateImageView) X(vkDestroyImageView) \
  X(vkCreateBuffer) X(vkDestroyBuffer) X(vkGetImageMemoryRequirements) X(vkGetBufferMemoryRequirements) \
  X(vkAllocateMemory) X(vkFreeMemory) X(vkBindImageMemory2) X(vkBindBufferMemory2) X(vkMapMemory) \
  X(vkCreateSampler) X(vkDestroySampler) \
  X(vkCreateDescriptorSetLayout) X(vkDestroyDescriptorSetLayout) \
  X(vkCreateDescriptorPool) X(vkDestroyDescriptorPool) X(vkAllocateDescriptorSets) X(vkUpdateDescriptorSets) \
  X(vkCreatePipelineLayout) X(vkDestroyPipelineLayout) X(vkCreateShaderModule) X(vkDestroyShaderModule) \
  X(vkCreateComputePipelines) X(vkDestroyPipeline) \
  X(vkCreateQueryPool) X(vkDestroyQueryPool) X(vkGetQueryPoolResults) \
  X(vkCmdPipelineBarrier2) X(vkCmdBindPipeline) X(vkCmdBindDescriptorSets) X(vkCmdPushConstants) \
  X(vkCmdDispatch) X(vkCmdDispatchIndirect) X(vkCmdFillBuffer) X(vkCmdClearColorImage) \
  X(vkCmdCopyBuffer) X(vkCmdCopyImage) \
  X(vkCmdResetQueryPool) X(vkCmdWriteTimestamp2)
#define DERMIS_LABEL_FUNCTIONS(X) \
  X(vkSetDebugUtilsObjectNameEXT) X(vkCmdBeginDebugUtilsLabelEXT) X(vkCmdEndDebugUtilsLabelEXT)
// clang-format on

namespace dermis::vulkan {

struct FunctionTable {
#define DERMIS_FUNCTION(name) PFN_##name name = nullptr;
  DERMIS_INSTANCE_FUNCTIONS(DERMIS_FUNCTION)
  DERMIS_DEVICE_FUNCTIONS(DERMIS_FUNCTION)
  DERMIS_LABEL_FUNCTIONS(DERMIS_FUNCTION) // null unless labels were requested
#undef DERMIS_FUNCTION
};

// Fills `table` and returns the names of all missing functions, in table order. Free-threaded.
std::vector<std::string> load_functions(PFN_vkGetInstanceProcAddr get_instance_proc_addr,
                                        VkInstance instance, VkDevice device, bool labels,
                                        FunctionTable& table);

} // namespace dermis::vulkan
