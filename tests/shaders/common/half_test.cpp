// Tests the rounding to half floats that kernels do before they store, independent of the driver's
// stores.
#include "tests/shaders/common/kernel_fixture.hpp"

#include "test_half.spv.h"

#include <bit>
#include <cmath>

namespace dermis {
namespace {

constexpr uint32_t width = 512, height = 1024; // The 2^19 upper bits of floats.
constexpr uint32_t tails[] = {0, 0xfff, 0x1000, 0x1001};

// Returns the nearest half float, ties to even, computed in fp64 with a single rounding step.
double nearest_half(float x) {
  const double bounded = std::fmin(std::fmax(double(x), -65504.0), 65504.0);
  const double step = std::ldexp(1.0, std::max(std::ilogb(bounded), -14) - 10);
  return std::fmin(std::fmax(std::nearbyint(bounded / step) * step, -65504.0), 65504.0);
}

class HalfKernel : public testing::KernelTest {};

TEST_F(HalfKernel, RoundsToTheNearestHalfAndTiesToEven) {
  const std::vector<float> answers = answers_of({"test_half", test_half_spirv}, width, height);
  ASSERT_EQ(answers.size(), size_t{4} * width * height);
  size_t judged = 0, wrong = 0;
  for (uint32_t head = 0; head < width * height; ++head)
    for (size_t c = 0; c < 4; ++c) {
      const float requested = std::bit_cast<float>(head << 13 | tails[c]);
      if (std::isnan(requested)) continue;
      ++judged;
      const double expected = requested == 0 ? 0 : nearest_half(requested);
      if (double(answers[4 * size_t{head} + c]) == expected) continue;
      if (++wrong <= 5)
        ADD_FAILURE() << requested << ": " << answers[4 * size_t{head} + c] << ", not " << expected;
    }
  EXPECT_EQ(wrong, 0u);
  EXPECT_EQ(judged, 4u * 512 * 1024 - 2 * 4 * 1024 + 2) << "all but NaN";
}

} // namespace
} // namespace dermis
