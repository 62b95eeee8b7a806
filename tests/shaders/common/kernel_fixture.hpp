#pragma once
// Runs a test kernel whose single image returns results of shared functions, in a host's
// environment.
#include "framegraph/vulkan/executor.hpp"
#include "passes/common/environment.hpp"
#include "tests/support/vulkan_fixture.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace dermis::testing {

// Contents of the environment's storage buffers; empty buffers hold zeros. `questions` becomes the
// rows of the separable table, which no tested function reads. `frame` holds the frame's constants;
// null gives zeros and a rectangle of the size of the answers.
struct KernelTables {
  std::span<const std::byte> profiles{}, radial{}, questions{};
  const subsurface::FrameConstants* frame = nullptr;
  uint32_t frame_flags = 0; // Added to FrameConstants::flags.
};

class KernelTest : public VulkanTest {
protected:
  // Runs the kernel once over `width` x `height` invocations, with port `target` as an rgba32f
  // image of that size. Returns its texels, 4 values each; empty if the test has failed.
  std::vector<float> answers_of(const vulkan::KernelCode& kernel, uint32_t width, uint32_t height,
                                const KernelTables& tables = {});

private:
  void run(const vulkan::KernelCode& kernel, uint32_t width, uint32_t height,
           const KernelTables& tables, std::vector<float>& answers);
};

} // namespace dermis::testing
