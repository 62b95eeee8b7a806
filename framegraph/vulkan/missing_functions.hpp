#pragma once
// Why a device does not have functions that the library calls: the version of the instance, an extension that
// is not enabled, or the device itself.

#include "framegraph/vulkan/function_table.hpp"

#include <span>
#include <string>

namespace dermis::vulkan {

// Returns what is missing and how to get it. `missing` comes from load_functions, `device_version` from
// VkPhysicalDeviceProperties. That version is the same for every instance, so the functions themselves show
// for which version the instance was created. Free-threaded.
std::string explain_missing(std::span<const std::string> missing, uint32_t device_version);

// Returns why an instance that was created for Vulkan 1.0 or 1.1 cannot be used, although the device
// supports 1.2 or later; else "". Such an instance hides what Vulkan 1.2 added, and answers that features are
// absent which the device has, even if every function that the library calls is there through extensions.
// Free-threaded.
std::string explain_old_instance(PFN_vkGetDeviceProcAddr get_device_proc_addr, VkDevice device,
                                 uint32_t device_version);

} // namespace dermis::vulkan
