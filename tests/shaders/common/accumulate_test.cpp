// Tests the functions of accumulate.glsl on a device: clipping of history, and the remainders that
// history stores. What the bench computes on the CPU as well is compared with that.
#include "passes/common/accumulate.hpp"
#include "tests/shaders/common/kernel_fixture.hpp"

#include "test_accumulate.spv.h"

#include <limits>

namespace dermis::subsurface::accumulate_kernel {
namespace {

constexpr double ulp = std::numeric_limits<float>::epsilon();

struct Case { // the layout that test_accumulate.comp reads
  float history[3] = {0, 0, 0}, count = 0;
  float mean[3] = {0, 0, 0}, reach = 1; // of the neighbours; also the mean light around
  float deviation[3] = {0, 0, 0}, minimum = 0.1f;
  float light[3] = {0, 0, 0}, part = 0;
  float near[3] = {0, 0, 0}, unused = 0;
};
static_assert(sizeof(Case) == 5 * 4 * sizeof(float));

class AccumulateKernel : public dermis::testing::KernelTest {
protected:
  using Value = std::array<double, 4>;
  void ask(const std::vector<Case>& cases) {
    count_ = static_cast<uint32_t>(cases.size());
    values_ = answers_of({"test_accumulate", test_accumulate_spirv}, count_, 5,
                         {.questions = std::as_bytes(std::span(cases))});
    ASSERT_EQ(values_.size(), size_t{4} * count_ * 5);
  }
  Value clipped(size_t i) const { return at(i, 0); }
  Value sum(size_t i) const { return at(i, 1); }
  Value weights(size_t i) const { return at(i, 2); }
  Value remainder(size_t i) const { return at(i, 3); } // the last value: 1 if it can be kept
  Value light(size_t i) const { return at(i, 4); }

private:
  Value at(size_t i, size_t row) const {
    Value value{};
    for (size_t c = 0; c < 4; ++c)
      value[c] = double(values_[4 * (row * count_ + i) + c]);
    return value;
  }
  std::vector<float> values_;
  uint32_t count_ = 0;
};

void expect_near(const std::array<double, 4>& found, const std::array<double, 4>& expected,
                 double tolerance) {
  for (size_t c = 0; c < 4; ++c)
    EXPECT_NEAR(found[c], expected[c], tolerance) << "channel " << c;
}

TEST_F(AccumulateKernel, HistoryFarFromNeighbours_IsClippedAndCountsLess) {
  Case near{.history = {1, 2, 3}, .count = 7, .mean = {1.1f, 2.1f, 2.9f}, .reach = 1.5f};
  Case far{.history = {3, 2, 1}, .count = 8, .mean = {1, 1, 1}, .reach = 2};
  Case flat = far; // all neighbours are equal
  std::fill_n(near.deviation, 3, 0.1f);
  far.deviation[0] = 0.25f;
  far.deviation[1] = far.deviation[2] = 1;
  ask({near, far, flat});
  if (HasFatalFailure() || IsSkipped()) return;
  expect_near(clipped(0), {1, 2, 3, 7}, 4 * ulp);
  // Red is 2 from the mean with a limit of 0.5, so all channels keep a quarter of the difference.
  expect_near(clipped(1), {1.5, 1.25, 1, 2}, 4 * ulp);
  expect_near(clipped(2), {1, 1, 1, 0}, 0);
}

TEST_F(AccumulateKernel, RemainderIsIndependentOfTheBrightness) {
  std::vector<Case> cases;
  for (const float factor : {1.0f, 1e-4f, 0.5f, 60.0f})
    cases.push_back({.mean = {0.4f * factor, 0.6f * factor, 0.3f * factor},
                     .light = {0.25f * factor, 0.4f * factor, 0.1f * factor},
                     .near = {0.2f * factor, 0.5f * factor, 0}});
  ask(cases);
  if (HasFatalFailure() || IsSkipped()) return;
  for (size_t i = 0; i < cases.size(); ++i)
    expect_near(remainder(i), {0.05 / 0.4, -0.1 / 0.6, 0.1 / 0.3, 1}, 8 * ulp);
}

TEST_F(AccumulateKernel, LightOfARemainder_IsNeverBelowZero) {
  const Case some{
      .history = {0.125f, -0.25f, 1}, .mean = {0.4f, 0.6f, 0.3f}, .near = {0.2f, 0.5f, 0}};
  Case dark = some;
  std::fill_n(dark.history, 3, -4.0f);
  ask({some, dark});
  if (HasFatalFailure() || IsSkipped()) return;
  expect_near(light(0), {0.25, 0.35, 0.3, 0}, 4 * ulp);
  expect_near(light(1), {0, 0, 0, 0}, 0);
}

TEST_F(AccumulateKernel, ExcessiveRemainders_AreNotKept) {
  const auto limit = static_cast<float>(accumulate_largest_remainder);
  ask({{.mean = {1, 1, 1}, .light = {0, limit, -limit}},
       {.mean = {1, 1, 1}, .light = {0, 0, limit + 0.01f}},
       {.mean = {1, 1, 1}, .light = {-limit - 0.01f, 0, 0}},
       {.light = {1, 1, 1}}}); // bright light, and darkness around
  if (HasFatalFailure() || IsSkipped()) return;
  for (size_t i = 0; i < 4; ++i)
    EXPECT_EQ(remainder(i)[3], i == 0 ? 1 : 0) << i;
}

TEST_F(AccumulateKernel, SumsAndWeightsEqualTheReference) {
  std::vector<Case> cases;
  for (int i = 0; i <= 64; ++i)
    cases.push_back({.history = {0.5f, 2, 1.0f / 3},
                     .count = float(i % 13),
                     .minimum = i % 2 == 0 ? 0.1f : 0.25f,
                     .light = {0.75f, 0.01f * float(i), 3},
                     .part = float(i) / 64});
  ask(cases);
  if (HasFatalFailure() || IsSkipped()) return;
  for (size_t i = 0; i < cases.size(); ++i) {
    const Case& one = cases[i];
    const AccumulatedLight expected =
        add_frame({{one.history[0], one.history[1], one.history[2]}, one.count},
                  {one.light[0], one.light[1], one.light[2]}, one.minimum);
    expect_near(sum(i), {expected.light[0], expected.light[1], expected.light[2], expected.count},
                16 * ulp);
    expect_near(weights(i), catmull_rom(one.part), 4 * ulp);
  }
}

} // namespace
} // namespace dermis::subsurface::accumulate_kernel
