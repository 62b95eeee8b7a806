#pragma once
// What the library has made of a device and not given back: a loader that counts, in front of the real one.

#include "integration/examples/demo_engine/vulkan_host.hpp"

#include <cstdint>
#include <string>

namespace dermis::abi_test {

struct ObjectCounts {
  uint64_t made = 0, alive = 0; // of all kinds
  uint64_t pipelines = 0;       // made
  std::string text;             // "3 images, 2 pipelines" of those that live; "none"
};

// To be given to contexts of `host`, whose calls are counted from now on; one host at a time, any thread.
PFN_vkGetInstanceProcAddr counting_loader(const demo::VulkanHost& host);

ObjectCounts object_counts();

} // namespace dermis::abi_test
