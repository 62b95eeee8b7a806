#pragma once
// Counts the device objects that the library has created and not destroyed, by a loader in front of
// the real one.

#include "integration/examples/demo_engine/vulkan_host.hpp"

#include <cstdint>
#include <string>

namespace dermis::abi_test {

struct ObjectCounts {
  uint64_t made = 0, alive = 0; // Counts of all types.
  uint64_t pipelines = 0;       // Number of creations.
  uint64_t alive_pipelines = 0;
  std::string text; // "3 images, 2 pipelines" for live objects; "none".
};

// Returns a loader for contexts of `host`, whose calls are counted from now on. One host at a time;
// any thread.
PFN_vkGetInstanceProcAddr counting_loader(const demo::VulkanHost& host);

ObjectCounts object_counts();

} // namespace dermis::abi_test
