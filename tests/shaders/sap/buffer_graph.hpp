#pragma once
// Runs a graph whose passes exchange only buffers: a kernel of the test fills buffers from a table,
// shipped kernels work on them, and another kernel of the test copies buffers to an image.
#include "tests/shaders/common/kernel_fixture.hpp"

#include <array>
#include <span>
#include <string>
#include <vector>

namespace dermis::testing {

// A pass type of the test and its kernel.
struct OwnPassType {
  PassType type;
  std::span<const uint32_t> spirv;
};

inline constexpr uint32_t answer_columns = 1024;

struct BufferGraph {
  uint32_t width = 0, height = 0; // of the view, in pixels
  PixelGrid grid = 0;
  // Graph that exports only an image `answers`: rgba32_uint, answer_columns x rows.
  std::string text = {};
  uint32_t rows = 0;
  std::vector<float> questions = {}; // rows of the separable table, which no other kernel reads
  std::vector<OwnPassType> own = {};
  vulkan::KernelShape shape = vulkan::KernelShape::by_device;
  uint32_t sample_units = 0;                        // as FrameConstants::sample_units
  uint32_t previous_width = 0, previous_height = 0; // 0: no previous camera
};

using BufferTexel = std::array<uint32_t, 4>;
struct BufferGraphAnswers {
  std::vector<BufferTexel> texels;
  subsurface::FrameCounters counters;
};

class BufferGraphTest : public KernelTest {
protected:
  // Runs one frame that covers the view.
  void run_graph(const BufferGraph& input, BufferGraphAnswers& answers);
};

} // namespace dermis::testing
