#include "integration/examples/demo_engine/vulkan_host.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <span>
#include <string_view>
#include <vector>

namespace demo {
namespace {

// Features that were extensions before Vulkan 1.3.
struct ExtensionFeatures {
  VkPhysicalDeviceSynchronization2Features synchronization2 =
      vulkan_struct<VkPhysicalDeviceSynchronization2Features>(
          VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SYNCHRONIZATION_2_FEATURES);
  VkPhysicalDeviceMaintenance4Features maintenance4 =
      vulkan_struct<VkPhysicalDeviceMaintenance4Features>(
          VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_MAINTENANCE_4_FEATURES);
};

bool has_extensions(VkPhysicalDevice device, std::span<const char* const> required) {
  uint32_t count = 0;
  vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr);
  std::vector<VkExtensionProperties> offered(count);
  vkEnumerateDeviceExtensionProperties(device, nullptr, &count, offered.data());
  return std::all_of(required.begin(), required.end(), [&](std::string_view name) {
    return std::any_of(offered.begin(), offered.end(),
                       [&](const VkExtensionProperties& one) { return name == one.extensionName; });
  });
}

constexpr const char* ray_extensions[] = {VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME,
                                          VK_KHR_RAY_QUERY_EXTENSION_NAME,
                                          VK_KHR_DEFERRED_HOST_OPERATIONS_EXTENSION_NAME};

constexpr const char* statistics_extensions[] = {
    VK_KHR_PIPELINE_EXECUTABLE_PROPERTIES_EXTENSION_NAME};

Result<> create_queue_objects(VulkanHost& host) {
  host.vk.vkGetDeviceQueue(host.device, host.queue_family, 0, &host.queue);
  auto pool = vulkan_struct<VkCommandPoolCreateInfo>(VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO);
  pool.queueFamilyIndex = host.queue_family;
  pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
  const VkResult pooled = host.vk.vkCreateCommandPool(host.device, &pool, nullptr, &host.pool);
  if (pooled != VK_SUCCESS) return vulkan_error("vkCreateCommandPool", pooled);
  const auto fence = vulkan_struct<VkFenceCreateInfo>(VK_STRUCTURE_TYPE_FENCE_CREATE_INFO);
  const VkResult fenced = host.vk.vkCreateFence(host.device, &fence, nullptr, &host.fence);
  if (fenced != VK_SUCCESS) return vulkan_error("vkCreateFence", fenced);
  return success();
}

Result<> create_device(VulkanHost& host, const HostOptions& options) {
  const bool as_vulkan_12 = options.as_vulkan_12;
  auto features13 = vulkan_struct<VkPhysicalDeviceVulkan13Features>(
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES);
  auto features12 = vulkan_struct<VkPhysicalDeviceVulkan12Features>(
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES);
  auto features11 = vulkan_struct<VkPhysicalDeviceVulkan11Features>(
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES);
  auto features =
      vulkan_struct<VkPhysicalDeviceFeatures2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2);
  features.pNext = &features11;
  features11.pNext = &features12;
  ExtensionFeatures extension_features;
  extension_features.synchronization2.pNext = &extension_features.maintenance4;
  if (as_vulkan_12)
    features12.pNext = &extension_features.synchronization2;
  else
    features12.pNext = &features13;
  auto structures = vulkan_struct<VkPhysicalDeviceAccelerationStructureFeaturesKHR>(
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ACCELERATION_STRUCTURE_FEATURES_KHR);
  auto queries = vulkan_struct<VkPhysicalDeviceRayQueryFeaturesKHR>(
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_RAY_QUERY_FEATURES_KHR);
  const bool rays = !as_vulkan_12 && has_extensions(host.physical_device, ray_extensions);
  if (rays) {
    queries.pNext = &structures;
    features13.pNext = &queries;
  }
  vkGetPhysicalDeviceFeatures2(host.physical_device, &features);
  host.ray_query = rays && structures.accelerationStructure && queries.rayQuery &&
                   features12.bufferDeviceAddress;
  if (!host.ray_query) features13.pNext = nullptr;
  auto statistics = vulkan_struct<VkPhysicalDevicePipelineExecutablePropertiesFeaturesKHR>(
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PIPELINE_EXECUTABLE_PROPERTIES_FEATURES_KHR);
  host.pipeline_statistics =
      options.compile_only && has_extensions(host.physical_device, statistics_extensions);
  if (host.pipeline_statistics) { // the extension requires the feature
    statistics.pipelineExecutableInfo = VK_TRUE;
    statistics.pNext = features.pNext;
    features.pNext = &statistics;
  }
  features.features.robustBufferAccess = VK_FALSE;
  features13.robustImageAccess = VK_FALSE;
  if (!options.separate_depth_stencil) features12.separateDepthStencilLayouts = VK_FALSE;
  const bool fits = as_vulkan_12 ? extension_features.synchronization2.synchronization2 &&
                                       extension_features.maintenance4.maintenance4
                                 : features13.synchronization2 && features13.dynamicRendering &&
                                       features13.maintenance4;
  if (!fits) {
    return Error{ErrorKind::environment,
                 fmt::format("'{}' lacks one of synchronization2, dynamicRendering, maintenance4",
                             host.properties.deviceName)};
  }
  const float priority = 1.0f;
  auto queue = vulkan_struct<VkDeviceQueueCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO);
  queue.queueFamilyIndex = host.queue_family;
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;
  auto info = vulkan_struct<VkDeviceCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO);
  info.pNext = &features;
  info.queueCreateInfoCount = 1;
  info.pQueueCreateInfos = &queue;
  std::vector<const char*> extensions;
  if (as_vulkan_12)
    extensions = {VK_KHR_SYNCHRONIZATION_2_EXTENSION_NAME, VK_KHR_MAINTENANCE_4_EXTENSION_NAME};
  else if (host.ray_query)
    extensions.assign(std::begin(ray_extensions), std::end(ray_extensions));
  if (host.pipeline_statistics) extensions.push_back(statistics_extensions[0]);
  info.enabledExtensionCount = static_cast<uint32_t>(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  const VkResult created = vkCreateDevice(host.physical_device, &info, nullptr, &host.device);
  if (created != VK_SUCCESS) return vulkan_error("vkCreateDevice", created);
  volkLoadDeviceTable(&host.vk, host.device);
  if (as_vulkan_12) {
    host.vk.vkCmdPipelineBarrier2 = host.vk.vkCmdPipelineBarrier2KHR;
    host.vk.vkQueueSubmit2 = host.vk.vkQueueSubmit2KHR;
  }
  vkGetPhysicalDeviceMemoryProperties(host.physical_device, &host.memory);
  return options.compile_only ? success() : create_queue_objects(host);
}

} // namespace

VulkanHost::~VulkanHost() {
  // a later host may have loaded its own functions
  if (instance != VK_NULL_HANDLE) volkLoadInstanceOnly(instance);
  if (device != VK_NULL_HANDLE) {
    if (pool != VK_NULL_HANDLE) vk.vkDeviceWaitIdle(device);
    engine_context.reset();
    tool_context.reset();
    vk.vkDestroyFence(device, fence, nullptr);
    vk.vkDestroyCommandPool(device, pool, nullptr);
    vk.vkDestroyDevice(device, nullptr);
  }
  if (messenger != VK_NULL_HANDLE) vkDestroyDebugUtilsMessengerEXT(instance, messenger, nullptr);
  if (instance != VK_NULL_HANDLE) vkDestroyInstance(instance, nullptr);
}

Result<std::unique_ptr<VulkanHost>> create_vulkan_host(const HostOptions& options) {
  if (auto done = load_vulkan(); !done) return done.error();
  auto host = std::make_unique<VulkanHost>();
  VulkanInstance made;
  const Result<> created = create_instance(options, host->log, made);
  host->instance = made.instance;
  host->messenger = made.messenger;
  if (!created) return created.error();
  const Result<ChosenDevice> chosen = choose_device(host->instance, options);
  if (!chosen) return chosen.error();
  host->physical_device = chosen->device;
  host->properties = chosen->properties;
  host->queue_family = chosen->queue_family;
  host->timestamp_mask = chosen->timestamp_mask;
  host->kernels = options.kernels;
  if (auto done = create_device(*host, options); !done) return done.error();
  return host;
}

Result<> run_commands(VulkanHost& host, const std::function<Result<>(VkCommandBuffer)>& record) {
  auto allocate =
      vulkan_struct<VkCommandBufferAllocateInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO);
  allocate.commandPool = host.pool;
  allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  allocate.commandBufferCount = 1;
  VkCommandBuffer commands = VK_NULL_HANDLE;
  VkResult result = host.vk.vkAllocateCommandBuffers(host.device, &allocate, &commands);
  if (result != VK_SUCCESS) return vulkan_error("vkAllocateCommandBuffers", result);
  auto begin = vulkan_struct<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  host.vk.vkBeginCommandBuffer(commands, &begin);
  Result<> recorded = record(commands);
  if (recorded) {
    result = host.vk.vkEndCommandBuffer(commands);
    auto buffer =
        vulkan_struct<VkCommandBufferSubmitInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO);
    buffer.commandBuffer = commands;
    auto submit = vulkan_struct<VkSubmitInfo2>(VK_STRUCTURE_TYPE_SUBMIT_INFO_2);
    submit.commandBufferInfoCount = 1;
    submit.pCommandBufferInfos = &buffer;
    if (result == VK_SUCCESS) result = host.vk.vkQueueSubmit2(host.queue, 1, &submit, host.fence);
    if (result == VK_SUCCESS)
      result = host.vk.vkWaitForFences(host.device, 1, &host.fence, VK_TRUE, UINT64_MAX);
    host.vk.vkResetFences(host.device, 1, &host.fence);
    if (result != VK_SUCCESS) recorded = vulkan_error("submitting commands", result);
  }
  host.vk.vkFreeCommandBuffers(host.device, host.pool, 1, &commands);
  return recorded;
}

uint32_t find_memory_type(const VulkanHost& host, uint32_t type_bits,
                          VkMemoryPropertyFlags preferred, VkMemoryPropertyFlags required) {
  for (const VkMemoryPropertyFlags flags : {preferred | required, required}) {
    for (uint32_t i = 0; i < host.memory.memoryTypeCount; ++i) {
      const bool allowed = (type_bits >> i) & 1u;
      if (allowed && (host.memory.memoryTypes[i].propertyFlags & flags) == flags) return i;
    }
  }
  return UINT32_MAX;
}

} // namespace demo
