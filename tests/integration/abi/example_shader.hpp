#pragma once
// Runs a compute shader of integration/examples once on a test's device.

#include "integration/examples/demo_engine/vulkan_image.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace dermis::abi_test {

struct ExampleShader {
  std::span<const uint32_t> spirv;
  std::vector<VkImageView> sampled;     // Bindings 0 .. n - 1, in the layout GENERAL.
  const demo::Image* written = nullptr; // Binding n; in the layout GENERAL before and after.
  std::span<const std::byte> push_constants;
};

// Runs one group per 8x8 texels of `written`. Waits for the device. Fails the test on errors.
void run_example(demo::VulkanHost& host, const ExampleShader& shader);

} // namespace dermis::abi_test
