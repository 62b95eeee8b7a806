#pragma once
// Runs one frame of kernels in a host's environment. Their single exported image returns results.
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

// A frame of a graph that exports only an image.
struct KernelFrame {
  const Graph& graph;
  const PassTypeRegistry& pass_types;
  std::span<const vulkan::KernelCode> kernels;
  uint32_t width, height; // of the view, in pixels
  const KernelTables& tables;
  VkFormat format; // of the image
  uint32_t image_width, image_height;
  PixelGrid grid = 0;
  vulkan::KernelShape shape = vulkan::KernelShape::by_device;
};

class KernelTest : public VulkanTest {
protected:
  // Returns the texels of the image and the counters of the frame; fails the test on errors.
  void run_frame(const KernelFrame& input, std::vector<std::byte>& texels,
                 subsurface::FrameCounters& counters);
  // Runs the kernel once over `width` x `height` invocations, with port `target` as an rgba32f
  // image of that size. Returns its texels, 4 values each; empty if the test has failed.
  std::vector<float> answers_of(const vulkan::KernelCode& kernel, uint32_t width, uint32_t height,
                                const KernelTables& tables = {});
};

} // namespace dermis::testing
