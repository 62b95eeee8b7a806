// Device properties: a current desktop device that supports every feature the library needs.
#include "integration/tools/null_device/state.hpp"

#include <algorithm>
#include <cstring>
#include <iterator>

namespace dermis {
namespace {

VKAPI_ATTR void VKAPI_CALL properties(VkPhysicalDevice, VkPhysicalDeviceProperties* out) {
  *out = {};
  out->apiVersion = VK_API_VERSION_1_3;
  out->deviceType = VK_PHYSICAL_DEVICE_TYPE_OTHER;
  constexpr char name[] = "null device";
  std::memcpy(out->deviceName, name, sizeof name);
  VkPhysicalDeviceLimits& limits = out->limits;
  limits.maxImageDimension2D = 16384;
  limits.maxImageArrayLayers = 2048;
  limits.maxUniformBufferRange = 65536;
  limits.maxStorageBufferRange = 1u << 30;
  limits.maxPushConstantsSize = 128; // the minimum that Vulkan guarantees
  limits.maxPerStageDescriptorStorageBuffers = limits.maxPerStageDescriptorUniformBuffers =
      limits.maxPerStageDescriptorSampledImages = limits.maxPerStageDescriptorStorageImages = 64;
  limits.maxPerStageResources = 256;
  limits.bufferImageGranularity = 1;
  limits.maxComputeSharedMemorySize = 32768;
  limits.maxComputeWorkGroupInvocations = 1024;
  for (uint32_t axis = 0; axis < 3; ++axis) {
    limits.maxComputeWorkGroupCount[axis] = 65535;
    limits.maxComputeWorkGroupSize[axis] = 1024;
  }
  limits.minUniformBufferOffsetAlignment = limits.minStorageBufferOffsetAlignment = 256;
  limits.timestampPeriod = 1.0F;
  limits.nonCoherentAtomSize = 1;
}

VKAPI_ATTR void VKAPI_CALL memory_properties(VkPhysicalDevice physical,
                                             VkPhysicalDeviceMemoryProperties* out) {
  *out = {};
  if (state_of(physical).discrete) {
    out->memoryTypeCount = out->memoryHeapCount = 2;
    out->memoryTypes[device_memory_type] = {VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 0};
    out->memoryTypes[host_memory_type] = {
        VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT, 1};
    out->memoryHeaps[0] = {VkDeviceSize{1} << 40, VK_MEMORY_HEAP_DEVICE_LOCAL_BIT};
    out->memoryHeaps[1] = {VkDeviceSize{1} << 40, 0};
    if (state_of(physical).full_bar) {
      out->memoryTypeCount = out->memoryHeapCount = 3;
      out->memoryTypes[bar_memory_type] = {out->memoryTypes[device_memory_type].propertyFlags |
                                               out->memoryTypes[host_memory_type].propertyFlags,
                                           2};
      out->memoryHeaps[2] = {VkDeviceSize{1} << 28, VK_MEMORY_HEAP_DEVICE_LOCAL_BIT};
    }
    return;
  }
  out->memoryTypeCount = out->memoryHeapCount = 1;
  out->memoryTypes[0].propertyFlags = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT |
                                      VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT |
                                      VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
  out->memoryHeaps[0] = {VkDeviceSize{1} << 40, VK_MEMORY_HEAP_DEVICE_LOCAL_BIT};
}

VKAPI_ATTR void VKAPI_CALL queue_families(VkPhysicalDevice physical, uint32_t* count,
                                          VkQueueFamilyProperties* out) {
  if (out != nullptr && *count > 0) {
    *out = {};
    out->queueFlags = state_of(physical).queue_flags;
    out->queueCount = 1;
    out->timestampValidBits = 64;
  }
  *count = 1;
}

VKAPI_ATTR void VKAPI_CALL format_properties(VkPhysicalDevice, VkFormat, VkFormatProperties2* out) {
  constexpr VkFormatFeatureFlags all = 0x7fffffff;
  out->formatProperties = {all, all, all};
}

VKAPI_ATTR VkResult VKAPI_CALL image_format_properties(VkPhysicalDevice,
                                                       const VkPhysicalDeviceImageFormatInfo2*,
                                                       VkImageFormatProperties2* out) {
  out->imageFormatProperties = {
      {16384, 16384, 1}, 15, 2048, VK_SAMPLE_COUNT_1_BIT, VkDeviceSize{1} << 36};
  return VK_SUCCESS;
}

VKAPI_ATTR void VKAPI_CALL features(VkPhysicalDevice, VkPhysicalDeviceFeatures2* out) {
  out->features.shaderStorageImageWriteWithoutFormat = VK_TRUE;
  for (auto* next = static_cast<VkBaseOutStructure*>(out->pNext); next != nullptr;
       next = next->pNext) {
    if (next->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SYNCHRONIZATION_2_FEATURES)
      reinterpret_cast<VkPhysicalDeviceSynchronization2Features*>(next)->synchronization2 = VK_TRUE;
    if (next->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_4_FEATURES)
      reinterpret_cast<VkPhysicalDeviceMaintenance4Features*>(next)->maintenance4 = VK_TRUE;
  }
}

VKAPI_ATTR VkResult VKAPI_CALL query_results(VkDevice device, VkQueryPool, uint32_t, uint32_t,
                                             size_t bytes, void* data, VkDeviceSize,
                                             VkQueryResultFlags) {
  std::fill_n(static_cast<std::byte*>(data), bytes, std::byte{0});
  return state_of(device).query_failure;
}

VKAPI_ATTR VkResult VKAPI_CALL name_object(VkDevice, const VkDebugUtilsObjectNameInfoEXT*) {
  return VK_SUCCESS;
}

VKAPI_ATTR void VKAPI_CALL reset_queries(VkDevice, VkQueryPool, uint32_t, uint32_t) {}

} // namespace

PFN_vkVoidFunction query_function(const char* name) {
  static const NullEntry entries[] = {
      entry("vkGetPhysicalDeviceProperties", &properties),
      entry("vkGetPhysicalDeviceMemoryProperties", &memory_properties),
      entry("vkGetPhysicalDeviceQueueFamilyProperties", &queue_families),
      entry("vkGetPhysicalDeviceFormatProperties2", &format_properties),
      entry("vkGetPhysicalDeviceImageFormatProperties2", &image_format_properties),
      entry("vkGetPhysicalDeviceFeatures2", &features),
      entry("vkGetQueryPoolResults", &query_results),
      // its presence indicates an instance of Vulkan 1.2 or later
      entry("vkResetQueryPool", &reset_queries),
      entry("vkSetDebugUtilsObjectNameEXT", &name_object),
  };
  return find_entry(entries, std::size(entries), name);
}

} // namespace dermis
