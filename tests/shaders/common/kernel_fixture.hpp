#pragma once
// A kernel of a test's own, whose one image hands out what shared functions say, with a host's environment
// around it.
#include "framegraph/vulkan/executor.hpp"
#include "passes/common/environment.hpp"
#include "tests/support/vulkan_fixture.hpp"

#include <cstddef>
#include <span>
#include <vector>

namespace dermis::testing {

// Contents of the environment's storage buffers; those that are empty hold zeros. `questions` becomes the
// rows of the separable table, which no function under test reads. `frame`: the frame's constants; null:
// zeros and a rectangle of the size of the answers.
struct KernelTables {
  std::span<const std::byte> profiles{}, radial{}, questions{};
  const subsurface::FrameConstants* frame = nullptr;
  uint32_t frame_flags = 0; // added to FrameConstants::flags
};

class KernelTest : public VulkanTest {
protected:
  // Runs the kernel once over `width` x `height` invocations, whose port `target` is an rgba32f image of that
  // size. Its texels, 4 values each; empty: the test has failed.
  std::vector<float> answers_of(const vulkan::KernelCode& kernel, uint32_t width, uint32_t height,
                                const KernelTables& tables = {});

private:
  void run(const vulkan::KernelCode& kernel, uint32_t width, uint32_t height, const KernelTables& tables,
           std::vector<float>& answers);
};

} // namespace dermis::testing
