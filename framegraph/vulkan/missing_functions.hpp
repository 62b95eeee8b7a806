#pragma once
// Explains why a device lacks functions that the library calls: the version of the instance, a
// disabled extension, or the device itself.

#include "framegraph/vulkan/function_table.hpp"

#include <span>
#include <string>

namespace dermis::vulkan {

// Returns what is missing and how to get it. `missing` comes from load_functions, `device_version`
// from VkPhysicalDeviceProperties. `device_version` does not depend on the instance, so the
// functions themselves show for which version the instance was created. Free-threaded.
std::string explain_missing(std::span<const std::string> missing, uint32_t device_version);

// Returns why an instance created for Vulkan 1.0 or 1.1 cannot be used although the device supports
// 1.2 or later; otherwise "". Such an instance hides the additions of Vulkan 1.2 and denies
// features that the device has, even if extensions provide every function that the library calls.
// Free-threaded.
std::string explain_old_instance(PFN_vkGetDeviceProcAddr get_device_proc_addr, VkDevice device,
                                 uint32_t device_version);

} // namespace dermis::vulkan
