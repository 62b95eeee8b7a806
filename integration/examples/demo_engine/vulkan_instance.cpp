#include "integration/examples/demo_engine/vulkan_instance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>

namespace demo {
namespace {

constexpr const char* validation_layer = "VK_LAYER_KHRONOS_validation";

VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                          VkDebugUtilsMessageTypeFlagsEXT,
                                          const VkDebugUtilsMessengerCallbackDataEXT* data,
                                          void* user) {
  auto& log = *static_cast<ValidationLog*>(user);
  const std::lock_guard lock(log.mutex);
  log.messages.push_back(fmt::format("{}: {}", data->pMessageIdName ? data->pMessageIdName : "",
                                     data->pMessage ? data->pMessage : ""));
  return VK_FALSE;
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

Error vulkan_error(const char* call, VkResult result) {
  return Error{ErrorKind::environment,
               fmt::format("{} failed: {} ({})", call, name_of(result), static_cast<int>(result))};
}

Result<> load_vulkan() {
  if (volkInitialize() == VK_SUCCESS) return success();
  return Error{ErrorKind::environment,
               "the Vulkan loader (libvulkan.so.1) was not found; install it (Debian: libvulkan1)"};
}

bool has_validation_layer() {
  uint32_t count = 0;
  vkEnumerateInstanceLayerProperties(&count, nullptr);
  std::vector<VkLayerProperties> layers(count);
  vkEnumerateInstanceLayerProperties(&count, layers.data());
  return std::any_of(layers.begin(), layers.end(), [](const VkLayerProperties& layer) {
    return std::strcmp(layer.layerName, validation_layer) == 0;
  });
}

Result<> create_instance(const HostOptions& options, ValidationLog& log, VulkanInstance& made) {
  auto application = vulkan_struct<VkApplicationInfo>(VK_STRUCTURE_TYPE_APPLICATION_INFO);
  application.pApplicationName = "dermis demo engine";
  application.apiVersion = options.as_vulkan_12 ? VK_API_VERSION_1_2 : VK_API_VERSION_1_3;
  auto info = vulkan_struct<VkInstanceCreateInfo>(VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO);
  info.pApplicationInfo = &application;

  auto messenger = vulkan_struct<VkDebugUtilsMessengerCreateInfoEXT>(
      VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT);
  messenger.messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
                              VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  messenger.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
  messenger.pfnUserCallback = on_message;
  messenger.pUserData = &log;
  const VkValidationFeatureEnableEXT enables[] = {
      VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
  auto features = vulkan_struct<VkValidationFeaturesEXT>(VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT);
  features.enabledValidationFeatureCount = 1;
  features.pEnabledValidationFeatures = enables;
  features.pNext = &messenger;
  const char* extensions[] = {VK_EXT_DEBUG_UTILS_EXTENSION_NAME,
                              VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME};
  if (options.validation) {
    if (!has_validation_layer()) {
      return Error{
          ErrorKind::environment,
          fmt::format("validation was requested, but the layer {} is not installed (Debian: "
                      "vulkan-validationlayers)",
                      validation_layer)};
    }
    // The check across submissions is not part of VkValidationFeaturesEXT; the layer reads this
    // variable instead.
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
  const VkResult created = vkCreateInstance(&info, nullptr, &made.instance);
  if (created == VK_ERROR_INCOMPATIBLE_DRIVER) {
    return Error{ErrorKind::environment,
                 "no Vulkan driver was found; install one (Debian: mesa-vulkan-drivers "
                 "has a software one) or set VK_DRIVER_FILES"};
  }
  if (created != VK_SUCCESS) return vulkan_error("vkCreateInstance", created);
  volkLoadInstanceOnly(made.instance);
  if (options.validation) {
    const VkResult listening =
        vkCreateDebugUtilsMessengerEXT(made.instance, &messenger, nullptr, &made.messenger);
    if (listening != VK_SUCCESS) return vulkan_error("vkCreateDebugUtilsMessengerEXT", listening);
  }
  return success();
}

namespace {

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

} // namespace

std::vector<VkPhysicalDevice> all_devices(VkInstance instance) {
  uint32_t count = 0;
  vkEnumeratePhysicalDevices(instance, &count, nullptr);
  std::vector<VkPhysicalDevice> devices(count);
  if (count > 0) vkEnumeratePhysicalDevices(instance, &count, devices.data());
  return devices;
}

Result<ChosenDevice> choose_device(VkInstance instance, const HostOptions& options) {
  const std::vector<VkPhysicalDevice> devices = all_devices(instance);
  std::string seen;
  ChosenDevice chosen;
  for (VkPhysicalDevice device : devices) {
    VkPhysicalDeviceProperties properties{};
    vkGetPhysicalDeviceProperties(device, &properties);
    seen += fmt::format("{}'{}'", seen.empty() ? "" : ", ", properties.deviceName);
    uint32_t timestamp_bits = 0;
    const uint32_t family = find_queue_family(device, timestamp_bits);
    const bool named =
        options.device.empty() ||
        std::string_view(properties.deviceName).find(options.device) != std::string_view::npos;
    if (properties.apiVersion < VK_API_VERSION_1_3 || family == UINT32_MAX || !named) continue;
    const bool better = properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU &&
                        chosen.properties.deviceType != VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU;
    if (chosen.device != VK_NULL_HANDLE && !better) continue;
    chosen.device = device;
    chosen.properties = properties;
    chosen.queue_family = family;
    chosen.timestamp_mask =
        timestamp_bits >= 64 ? ~uint64_t{0} : (uint64_t{1} << timestamp_bits) - 1;
  }
  if (chosen.device != VK_NULL_HANDLE) return chosen;
  if (devices.empty()) return Error{ErrorKind::environment, "the Vulkan driver offers no device"};
  return Error{
      ErrorKind::environment,
      fmt::format("no device fits{}: Vulkan 1.3 and a queue for graphics and compute are needed; "
                  "there are {}",
                  options.device.empty() ? "" : fmt::format(" the name '{}'", options.device),
                  seen)};
}

} // namespace demo
