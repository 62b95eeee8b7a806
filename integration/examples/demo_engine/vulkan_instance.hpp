#pragma once
// Access to a Vulkan device: loader, instance, and selection of a device.

#include "integration/examples/demo_engine/kernel_shape.hpp"
#include "integration/examples/demo_engine/result.hpp"

#include <volk.h>

#include <mutex>
#include <string>
#include <vector>

namespace demo {

struct HostOptions {
  // Khronos layer with core and synchronization checks, also across submissions
  bool validation = false;
  // Part of the device's name; "" = the first discrete GPU, else the first device.
  std::string device;
  bool as_vulkan_12 = false; // emulates an engine before Vulkan 1.3: 1.2 and extensions
  // false: without the feature separateDepthStencilLayouts
  bool separate_depth_stencil = true;
  KernelShape kernels = KernelShape::by_device;
  // A device that only compiles pipelines: no command pool and no fence, and the destructor does
  // not wait. Drivers without hardware, such as RADV's null device, can do no more.
  bool compile_only = false;
};

// Messages of the validation layer. Any thread that calls Vulkan may add messages.
struct ValidationLog {
  std::mutex mutex;
  std::vector<std::string> messages; // warnings and errors
};

struct VulkanInstance {
  VkInstance instance = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger = VK_NULL_HANDLE; // only with validation
};

struct ChosenDevice {
  VkPhysicalDevice device = VK_NULL_HANDLE;
  VkPhysicalDeviceProperties properties{};
  uint32_t queue_family = 0;   // graphics and compute
  uint64_t timestamp_mask = 0; // 0: the queue has no timestamps
};

// Loads the functions that need no instance. Errors: environment if there is no loader.
Result<> load_vulkan();

// Returns whether the Khronos layer is installed. Call load_vulkan() first.
bool has_validation_layer();

// Creates an instance for Vulkan 1.3 (or 1.2), whose messages go to `log`. On failure, `made` holds
// what was created so far. Errors: environment if there is no driver or no layer.
Result<> create_instance(const HostOptions& options, ValidationLog& log, VulkanInstance& made);

// Returns all devices of the instance, in the driver's order.
std::vector<VkPhysicalDevice> all_devices(VkInstance instance);

// Errors: environment if no device is suitable.
Result<ChosenDevice> choose_device(VkInstance instance, const HostOptions& options);

// Returns an Error of kind environment, such as "vkQueueSubmit2 failed: VK_ERROR_DEVICE_LOST".
Error vulkan_error(const char* call, VkResult result);

// Returns a zeroed Vulkan struct with its type set.
template <class T> T vulkan_struct(VkStructureType type) {
  T value{};
  value.sType = type;
  return value;
}

} // namespace demo
