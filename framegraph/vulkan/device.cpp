#include "framegraph/vulkan/device.hpp"

#include "framegraph/vulkan/missing_functions.hpp"

#include <fmt/format.h>

namespace dermis::vulkan {
namespace {

Error check_handles(const DeviceInput& input) {
  std::string null;
  const auto require = [&](bool given, const char* name) {
    if (!given) null += (null.empty() ? "" : ", ") + std::string(name);
  };
  require(input.get_instance_proc_addr != nullptr, "get_instance_proc_addr");
  require(input.instance != VK_NULL_HANDLE, "instance");
  require(input.physical != VK_NULL_HANDLE, "physical device");
  require(input.device != VK_NULL_HANDLE, "device");
  if (null.empty()) return {};
  return {ErrorKind::argument, VK_SUCCESS, "a required handle is null: " + null};
}

bool allows_wide_groups(const VkPhysicalDeviceLimits& limits) {
  return limits.maxComputeWorkGroupInvocations >= wide_group_lanes &&
         limits.maxComputeWorkGroupSize[0] >= wide_group_lanes &&
         limits.maxComputeSharedMemorySize >= 32768;
}

Error read_queue_family(const DeviceInput& input, Device& device) {
  uint32_t count = 0;
  device.vk.vkGetPhysicalDeviceQueueFamilyProperties(device.physical, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  device.vk.vkGetPhysicalDeviceQueueFamilyProperties(device.physical, &count, families.data());
  if (input.queue_family >= count)
    return {ErrorKind::argument, VK_SUCCESS,
            fmt::format("queue family {} does not exist; the device has {}", input.queue_family,
                        count)};
  const VkQueueFamilyProperties& family = families[input.queue_family];
  if ((family.queueFlags & VK_QUEUE_COMPUTE_BIT) == 0)
    return {ErrorKind::argument, VK_SUCCESS,
            fmt::format(
                "queue family {} does not support compute; use a family with VK_QUEUE_COMPUTE_BIT",
                input.queue_family)};
  device.queue_family = input.queue_family;
  device.timestamp_valid_bits = family.timestampValidBits;
  return {};
}

} // namespace

Error make_device(const DeviceInput& input, Device& device) {
  if (Error error = check_handles(input)) return error;
  device = {};
  const std::vector<std::string> missing = load_functions(
      input.get_instance_proc_addr, input.instance, input.device, input.labels, device.vk);
  device.instance = input.instance;
  device.physical = input.physical;
  device.device = input.device;
  device.allocator = input.allocator;
  if (device.vk.vkGetPhysicalDeviceProperties != nullptr)
    device.vk.vkGetPhysicalDeviceProperties(device.physical, &device.properties);
  if (!missing.empty())
    return {ErrorKind::unsupported, VK_SUCCESS,
            explain_missing(missing, device.properties.apiVersion)};
  device.vk.vkGetPhysicalDeviceMemoryProperties(device.physical, &device.memory);
  const uint32_t version = device.properties.apiVersion;
  if (version < VK_API_VERSION_1_2)
    return {ErrorKind::unsupported, VK_SUCCESS,
            fmt::format("the device {} supports Vulkan {}.{}; 1.2 is required",
                        device.properties.deviceName, VK_API_VERSION_MAJOR(version),
                        VK_API_VERSION_MINOR(version))};
  if (std::string reason =
          explain_old_instance(device.vk.vkGetDeviceProcAddr, device.device, version);
      !reason.empty())
    return {ErrorKind::unsupported, VK_SUCCESS, std::move(reason)};
  if (Error error = read_queue_family(input, device)) return error;
  device.features = input.features;
  device.separate_depth_stencil = input.separate_depth_stencil;
  device.texel_shape = input.kernel_shape == KernelShape::by_device
                           ? device.properties.deviceType != VK_PHYSICAL_DEVICE_TYPE_CPU
                           : input.kernel_shape == KernelShape::texel;
  device.wide_groups =
      device.texel_shape && !input.small_groups && allows_wide_groups(device.properties.limits);
  device.labels = input.labels;
  device.host_memory = input.host_memory;
  device.timings = input.timings && device.timestamp_valid_bits > 0;
  return {};
}

void name_object(const Device& device, VkObjectType type, uint64_t handle, const char* name) {
  if (!device.labels || handle == 0) return;
  const VkDebugUtilsObjectNameInfoEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT,
                                           nullptr, type, handle, name};
  // Names are a debugging aid, so a failure is ignored.
  static_cast<void>(device.vk.vkSetDebugUtilsObjectNameEXT(device.device, &info));
}

} // namespace dermis::vulkan
