#include "integration/demo_engine/vulkan_host.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>

namespace demo {
namespace {

constexpr const char* validation_layer = "VK_LAYER_KHRONOS_validation";

VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                          VkDebugUtilsMessageTypeFlagsEXT,
                                          const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
  auto& log = *static_cast<ValidationLog*>(user);
  const std::lock_guard lock(log.mutex);
  log.messages.push_back(fmt::format("{}: {}", data->pMessageIdName ? data->pMessageIdName : "",
                                     data->pMessage ? data->pMessage : ""));
  return VK_FALSE;
}

bool layer_is_there() {
  uint32_t count = 0;
  vkEnumerateInstanceLayerProperties(&count, nullptr);
  std::vector<VkLayerProperties> layers(count);
  vkEnumerateInstanceLayerProperties(&count, layers.data());
  return std::any_of(layers.begin(), layers.end(), [](const VkLayerProperties& layer) {
    return std::strcmp(layer.layerName, validation_layer) == 0;
  });
}

Result<> create_instance(VulkanHost& host, const HostOptions& options) {
  auto application = vulkan_struct<VkApplicationInfo>(VK_STRUCTURE_TYPE_APPLICATION_INFO);
  application.pApplicationName = "dermis demo engine";
  application.apiVersion = VK_API_VERSION_1_3;
  auto info = vulkan_struct<VkInstanceCreateInfo>(VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO);
  info.pApplicationInfo = &application;

  auto messenger = vulkan_struct<VkDebugUtilsMessengerCreateInfoEXT>(
      VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT);
  messenger.messageSeverity =
      VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  messenger.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
  messenger.pfnUserCallback = on_message;
  messenger.pUserData = &host.log;
  const VkValidationFeatureEnableEXT enables[] = {
      VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
  auto features = vulkan_struct<VkValidationFeaturesEXT>(VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT);
  features.enabledValidationFeatureCount = 1;
  features.pEnabledValidationFeatures = enables;
  features.pNext = &messenger;
  const char* extensions[] = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME, VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME};
  if (options.validation) {
    if (!layer_is_there()) {
      return Error{ErrorKind::environment,
                   fmt::format("validation was asked for, but the layer {} is not installed (Debian: "
                               "vulkan-validationlayers)",
                               validation_layer)};
    }
    // The check across submissions has no place in VkValidationFeaturesEXT; the layer reads it from here.
    setenv("VK_LAYER_ENABLES",
           "VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT:"
           "VALIDATION_CHECK_ENABLE_SYNCHRONIZATION_VALIDATION_QUEUE_SUBMIT",
           0);
    info.enabledLayerCount = 1;
    info.ppEnabledLayerNames = &validation_layer;
    info.enabledExtensionCount = 2;
    info.ppEnabledExtensionNames = extensions;
    info.pNext = &features;
  }
  const VkResult created = vkCreateInstance(&info, nullptr, &host.instance);
  if (created == VK_ERROR_INCOMPATIBLE_DRIVER) {
    return Error{ErrorKind::environment,
                 "no Vulkan driver was found; install one (Debian: mesa-vulkan-drivers "
                 "has a software one) or set VK_DRIVER_FILES"};
  }
  if (created != VK_SUCCESS) return vulkan_error("vkCreateInstance", created);
  volkLoadInstanceOnly(host.instance);
  if (options.validation) {
    const VkResult made = vkCreateDebugUtilsMessengerEXT(host.instance, &messenger, nullptr, &host.messenger);
    if (made != VK_SUCCESS) return vulkan_error("vkCreateDebugUtilsMessengerEXT", made);
  }
  return success();
}

uint32_t find_queue_family(VkPhysicalDevice device, uint32_t& timestamp_bits) {
  uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
  constexpr VkQueueFlags needed = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
  for (uint32_t i = 0; i < count; ++i) {
    if ((families[i].queueFlags & needed) != needed) continue;
    timestamp_bits = families[i].timestampValidBits;
    return i;
  }
  return UINT32_MAX;
}

Result<> choose_device(VulkanHost& host, const HostOptions& options) {
  uint32_t count = 0;
  vkEnumeratePhysicalDevices(host.instance, &count, nullptr);
  std::vector<VkPhysicalDevice> devices(count);
  if (count > 0) vkEnumeratePhysicalDevices(host.instance, &count, devices.data());
  std::string seen;
  bool chosen = false;
  for (VkPhysicalDevice device : devices) {
    VkPhysicalDeviceProperties properties{};
    vkGetPhysicalDeviceProperties(device, &properties);
    seen += fmt::format("{}'{}'", seen.empty() ? "" : ", ", properties.deviceName);
    uint32_t timestamp_bits = 0;
    const uint32_t family = find_queue_family(device, timestamp_bits);
    const bool named = options.device.empty() ||
                       std::string_view(properties.deviceName).find(options.device) != std::string_view::npos;
    if (properties.apiVersion < VK_API_VERSION_1_3 || family == UINT32_MAX || !named) continue;
    const bool better = properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU &&
                        host.properties.deviceType != VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU;
    if (chosen && !better) continue;
    chosen = true;
    host.physical_device = device;
    host.properties = properties;
    host.queue_family = family;
    host.timestamp_mask = timestamp_bits >= 64 ? ~uint64_t{0} : (uint64_t{1} << timestamp_bits) - 1;
  }
  if (chosen) return success();
  if (devices.empty()) return Error{ErrorKind::environment, "the Vulkan driver offers no device"};
  return Error{ErrorKind::environment,
               fmt::format("no device fits{}: Vulkan 1.3 and a queue for graphics and compute are needed; "
                           "there are {}",
                           options.device.empty() ? "" : fmt::format(" the name '{}'", options.device),
                           seen)};
}

Result<> create_device(VulkanHost& host) {
  auto features13 =
      vulkan_struct<VkPhysicalDeviceVulkan13Features>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES);
  auto features12 =
      vulkan_struct<VkPhysicalDeviceVulkan12Features>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES);
  auto features11 =
      vulkan_struct<VkPhysicalDeviceVulkan11Features>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES);
  auto features = vulkan_struct<VkPhysicalDeviceFeatures2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2);
  features.pNext = &features11;
  features11.pNext = &features12;
  features12.pNext = &features13;
  vkGetPhysicalDeviceFeatures2(host.physical_device, &features);
  features.features.robustBufferAccess = VK_FALSE;
  features13.robustImageAccess = VK_FALSE;
  if (!features13.synchronization2 || !features13.dynamicRendering || !features13.maintenance4) {
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
  const VkResult created = vkCreateDevice(host.physical_device, &info, nullptr, &host.device);
  if (created != VK_SUCCESS) return vulkan_error("vkCreateDevice", created);
  volkLoadDeviceTable(&host.vk, host.device);
  host.vk.vkGetDeviceQueue(host.device, host.queue_family, 0, &host.queue);
  vkGetPhysicalDeviceMemoryProperties(host.physical_device, &host.memory);

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

const char* name_of(VkResult result) {
  switch (result) {
  case VK_ERROR_OUT_OF_HOST_MEMORY:
    return "VK_ERROR_OUT_OF_HOST_MEMORY";
  case VK_ERROR_OUT_OF_DEVICE_MEMORY:
    return "VK_ERROR_OUT_OF_DEVICE_MEMORY";
  case VK_ERROR_INITIALIZATION_FAILED:
    return "VK_ERROR_INITIALIZATION_FAILED";
  case VK_ERROR_DEVICE_LOST:
    return "VK_ERROR_DEVICE_LOST";
  case VK_ERROR_LAYER_NOT_PRESENT:
    return "VK_ERROR_LAYER_NOT_PRESENT";
  case VK_ERROR_EXTENSION_NOT_PRESENT:
    return "VK_ERROR_EXTENSION_NOT_PRESENT";
  case VK_ERROR_FEATURE_NOT_PRESENT:
    return "VK_ERROR_FEATURE_NOT_PRESENT";
  case VK_ERROR_INCOMPATIBLE_DRIVER:
    return "VK_ERROR_INCOMPATIBLE_DRIVER";
  case VK_ERROR_FORMAT_NOT_SUPPORTED:
    return "VK_ERROR_FORMAT_NOT_SUPPORTED";
  case VK_TIMEOUT:
    return "VK_TIMEOUT";
  default:
    return "";
  }
}

} // namespace

VulkanHost::~VulkanHost() {
  if (device != VK_NULL_HANDLE) {
    vk.vkDeviceWaitIdle(device);
    vk.vkDestroyFence(device, fence, nullptr);
    vk.vkDestroyCommandPool(device, pool, nullptr);
    vk.vkDestroyDevice(device, nullptr);
  }
  if (messenger != VK_NULL_HANDLE) vkDestroyDebugUtilsMessengerEXT(instance, messenger, nullptr);
  if (instance != VK_NULL_HANDLE) vkDestroyInstance(instance, nullptr);
}

Result<std::unique_ptr<VulkanHost>> create_vulkan_host(const HostOptions& options) {
  if (volkInitialize() != VK_SUCCESS) {
    return Error{ErrorKind::environment,
                 "the Vulkan loader (libvulkan.so.1) was not found; install it (Debian: libvulkan1)"};
  }
  auto host = std::make_unique<VulkanHost>();
  if (auto done = create_instance(*host, options); !done) return done.error();
  if (auto done = choose_device(*host, options); !done) return done.error();
  if (auto done = create_device(*host); !done) return done.error();
  return host;
}

Result<> run_commands(VulkanHost& host, const std::function<Result<>(VkCommandBuffer)>& record) {
  auto allocate = vulkan_struct<VkCommandBufferAllocateInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO);
  allocate.commandPool = host.pool;
  allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  allocate.commandBufferCount = 1;
  VkCommandBuffer commands = VK_NULL_HANDLE;
  VkResult result = host.vk.vkAllocateCommandBuffers(host.device, &allocate, &commands);
  if (result != VK_SUCCESS) return vulkan_error("vkAllocateCommandBuffers", result);
  auto begin = vulkan_struct<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  host.vk.vkBeginCommandBuffer(commands, &begin);
  Result<> outcome = record(commands);
  if (outcome) {
    result = host.vk.vkEndCommandBuffer(commands);
    auto buffer = vulkan_struct<VkCommandBufferSubmitInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO);
    buffer.commandBuffer = commands;
    auto submit = vulkan_struct<VkSubmitInfo2>(VK_STRUCTURE_TYPE_SUBMIT_INFO_2);
    submit.commandBufferInfoCount = 1;
    submit.pCommandBufferInfos = &buffer;
    if (result == VK_SUCCESS) result = host.vk.vkQueueSubmit2(host.queue, 1, &submit, host.fence);
    if (result == VK_SUCCESS)
      result = host.vk.vkWaitForFences(host.device, 1, &host.fence, VK_TRUE, UINT64_MAX);
    host.vk.vkResetFences(host.device, 1, &host.fence);
    if (result != VK_SUCCESS) outcome = vulkan_error("submitting commands", result);
  }
  host.vk.vkFreeCommandBuffers(host.device, host.pool, 1, &commands);
  return outcome;
}

Error vulkan_error(const char* call, VkResult result) {
  return Error{ErrorKind::environment,
               fmt::format("{} failed: {} ({})", call, name_of(result), static_cast<int>(result))};
}

uint32_t find_memory_type(const VulkanHost& host, uint32_t type_bits, VkMemoryPropertyFlags wanted,
                          VkMemoryPropertyFlags needed) {
  for (const VkMemoryPropertyFlags flags : {wanted | needed, needed}) {
    for (uint32_t i = 0; i < host.memory.memoryTypeCount; ++i) {
      const bool allowed = (type_bits >> i) & 1u;
      if (allowed && (host.memory.memoryTypes[i].propertyFlags & flags) == flags) return i;
    }
  }
  return UINT32_MAX;
}

} // namespace demo
