#pragma once
// Builds the DeviceProfile of a real device: sizes, alignments, memory types and formats as the
// driver states them.

#include "framegraph/compile/device_profile.hpp"
#include "framegraph/vulkan/device.hpp"

namespace dermis::vulkan {

// Queries the driver with the same create infos that an Executor uses. The functions of the result
// refer to `device`, which must outlive it. Free-threaded, as are the functions of the result.
DeviceProfile device_profile(const Device& device);

} // namespace dermis::vulkan
