// Tests how kernels read directions that a host stores in its own view space.
#include "passes/common/environment.hpp"
#include "tests/shaders/common/kernel_fixture.hpp"

#include "test_camera.spv.h"

namespace dermis {
namespace {

// Computed by fill_frame_constants.
uint32_t flags_of(subsurface::Handedness handedness) {
  subsurface::FrameInput input;
  input.rect_width = input.rect_height = 8;
  input.camera.clip_from_view = {1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 0, 0.1, 0, 0, -1, 0};
  input.handedness = handedness;
  subsurface::FrameConstants constants{};
  EXPECT_TRUE(subsurface::fill_frame_constants(input, constants));
  return constants.flags;
}

class CameraKernel : public testing::KernelTest {};

TEST_F(CameraKernel, TurnsNormalsOfALeftHandedHost) {
  for (const subsurface::Handedness handedness :
       {subsurface::Handedness::right, subsurface::Handedness::left}) {
    testing::KernelTables tables;
    tables.frame_flags = flags_of(handedness);
    const std::vector<float> answers = answers_of({"test_camera", test_camera_spirv}, 8, 8, tables);
    ASSERT_EQ(answers.size(), size_t{4} * 8 * 8);
    for (size_t i = 0; i < 64; ++i) {
      const float x = float(i % 8), y = float(i / 8), z = x - y + 0.5f;
      EXPECT_EQ(answers[4 * i], x);
      EXPECT_EQ(answers[4 * i + 1], y);
      EXPECT_EQ(answers[4 * i + 2], handedness == subsurface::Handedness::left ? -z : z);
    }
  }
}

} // namespace
} // namespace dermis
