#pragma once
// Lists what the library needs of a physical device, with a reason for each item.

#include "integration/include/dermis/dermis.h"

#include <array>
#include <string_view>

namespace dermis::abi {

inline constexpr uint32_t requirement_count = 10;
// items from here on are only needed with DERMIS_CONTEXT_RAY_QUERY
inline constexpr uint32_t first_ray_requirement = 6;

// Returns every requirement with `present` filled from the device. All are absent if the functions
// to query are missing.
std::array<dermis_requirement, requirement_count>
requirements_of(PFN_vkGetInstanceProcAddr get_instance_proc_addr, VkInstance instance,
                VkPhysicalDevice physical_device);

// Returns whether the physical device offers the extension; the device may have been created
// without it.
bool has_device_extension(PFN_vkGetInstanceProcAddr get_instance_proc_addr, VkInstance instance,
                          VkPhysicalDevice physical_device, std::string_view name);

} // namespace dermis::abi
