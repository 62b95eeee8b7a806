#pragma once
// The way to a Vulkan device: loader, instance, and which of the devices is taken.

#include "integration/examples/demo_engine/result.hpp"

#include <volk.h>

#include <mutex>
#include <string>
#include <vector>

namespace demo {

struct HostOptions {
  bool validation = false;   // Khronos layer with core and synchronization checks, also across submissions
  std::string device;        // part of the device's name; "" = the first discrete GPU, else the first device
  bool as_vulkan_12 = false; // as an engine that is not on 1.3 yet: 1.2 and extensions
  bool separate_depth_stencil = true; // false: without the feature separateDepthStencilLayouts
};

// What the validation layer said. Filled from any thread that calls Vulkan.
struct ValidationLog {
  std::mutex mutex;
  std::vector<std::string> messages; // warnings and errors
};

struct VulkanInstance {
  VkInstance instance = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger = VK_NULL_HANDLE; // with validation alone
};

struct ChosenDevice {
  VkPhysicalDevice device = VK_NULL_HANDLE;
  VkPhysicalDeviceProperties properties{};
  uint32_t queue_family = 0;   // graphics and compute
  uint64_t timestamp_mask = 0; // 0: the queue has no timestamps
};

// Loads the functions that need no instance. Errors: environment when there is no loader.
Result<> load_vulkan();

// Is the Khronos layer installed? After load_vulkan().
bool validation_layer_is_there();

// An instance for Vulkan 1.3 (or 1.2), whose messages go to `log`. `made` is filled as far as it came also on
// failure. Errors: environment when there is no driver or no layer.
Result<> create_instance(const HostOptions& options, ValidationLog& log, VulkanInstance& made);

// All devices of the instance, in the driver's order.
std::vector<VkPhysicalDevice> all_devices(VkInstance instance);

// Errors: environment when no device fits.
Result<ChosenDevice> choose_device(VkInstance instance, const HostOptions& options);

// "vkQueueSubmit2 failed: VK_ERROR_DEVICE_LOST", as an Error of kind environment.
Error vulkan_error(const char* call, VkResult result);

// A zeroed Vulkan struct with its type set.
template <class T> T vulkan_struct(VkStructureType type) {
  T value{};
  value.sType = type;
  return value;
}

} // namespace demo
