// Tests paths that frames and pixels share, on a device: no bias, no ghosts, and nothing from
// before a cut. The periods of a sequence are independent restarts with separate histories and
// random numbers. The reference is the mean of many of the graph's own paths without reuse;
// rays_test.cpp compares these with another sampler.
#include "tests/framegraph/test_scale.hpp"
#include "tests/integration/examples/demo_engine/moving_sheet.hpp"
#include "tests/integration/examples/demo_engine/ray_queries.hpp"
#include "tests/passes/restir/statistics.hpp"
#include "tests/support/test_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>

namespace demo {
namespace {

using dermis::restir::testing::Mean;
using dermis::restir::testing::mean_of;

constexpr size_t min_pixels = 20; // Per region.
constexpr double confidence_cap = 20;

uint32_t quality(uint32_t quick, uint32_t full) {
  return static_cast<uint32_t>(dermis::testing::seeds_to_try(quick, full));
}

const uint32_t side = quality(32, 64); // Pixels of a picture.

std::vector<std::string> shifts() { // Shifts of the tests that check a frame after a change.
  if (quality(0, 1) != 0) return {"delayed", "reconnection", "hybrid", "sequential"};
  return {"reconnection"}; // Its paths keep their light, except for the update by restir.temporal.
}

struct Way { // A way to reuse paths.
  std::string reuse, shift;
};

struct ReuseWithRayQueries : WithRayQueries {
  void SetUp() override {
    WithRayQueries::SetUp();
    if (IsSkipped()) return;
    std::filesystem::copy_file(source + "/configs/profiles/skin.json", folder / "skin.json");
  }
  std::vector<FrameOutputs> frames_of(const Motion& motion, const Way& way, uint32_t periods,
                                      uint32_t samples = 1) const {
    const uint32_t frames = periods * motion.period;
    const std::string path = (folder / "scene.json").string();
    std::ofstream(path) << moving_sheet(motion, frames, "skin.json");
    return rendered(by_rays(path, side, frames,
                            {{"reuse", "\"" + way.reuse + "\""},
                             {"shift", "\"" + way.shift + "\""},
                             {"samples", std::to_string(samples)}}))
        .frames;
  }

  const dermis::test::TestFolder folder;
};

// Returns the pixels with subsurface of a frame: all, and those of each quarter of the picture.
std::vector<std::vector<size_t>> regions_of(const FrameOutputs& frame) {
  std::vector<std::vector<size_t>> regions(5);
  for (size_t i = 0; i < frame.inputs.profile.texels.size(); ++i) {
    if (frame.inputs.profile.texels[i] == 0) continue;
    regions[0].push_back(i);
    regions[1 + (i % side < side / 2 ? 0 : 1) + (i / side < side / 2 ? 0 : 2)].push_back(i);
  }
  return regions;
}

double mean_over(const FloatImage& light, const std::vector<size_t>& pixels) {
  double sum = 0;
  for (const size_t pixel : pixels)
    sum += luminance(light, pixel);
  return pixels.empty() ? 0 : sum / double(pixels.size());
}

// Returns the light of each region in the checked frames, by period.
std::vector<std::vector<double>> lights_of(const std::vector<FrameOutputs>& frames,
                                           const Motion& motion, uint32_t judged_from,
                                           uint32_t judged_to) {
  std::vector<std::vector<double>> values(5);
  for (size_t first = 0; first < frames.size(); first += motion.period) {
    std::vector<double> sums(5);
    for (uint32_t phase = judged_from; phase < judged_to; ++phase) {
      const auto regions = regions_of(frames[phase]); // Equal in each period.
      for (size_t r = 0; r < 5; ++r)
        if (regions[r].size() >= min_pixels)
          sums[r] += mean_over(frames[first + phase].scattered, regions[r]);
    }
    for (size_t r = 0; r < 5; ++r)
      values[r].push_back(sums[r] / (judged_to - judged_from));
  }
  return values;
}

struct Judged {
  // In sigma; relative; relative sigma of the whole picture.
  double worst = 0, largest = 0, spread = 0;
};
Judged judge(const std::vector<std::vector<double>>& found,
             const std::vector<std::vector<double>>& reference) {
  Judged judged;
  for (size_t r = 0; r < found.size(); ++r) {
    const Mean one = mean_of(found[r]), other = mean_of(reference[r]);
    if (!(other.mean > 0)) continue;
    judged.worst = std::max(judged.worst, std::abs(deviation(one, other)));
    judged.largest = std::max(judged.largest, std::abs(one.mean / other.mean - 1));
    if (r == 0) judged.spread = std::hypot(one.sigma, other.sigma) / other.mean;
  }
  return judged;
}

double square_of(const FrameOutputs& frame, const std::vector<double>& reference) {
  double sum = 0;
  for (size_t i = 0; i < reference.size(); ++i)
    sum += std::pow(luminance(frame.scattered, i) - reference[i], 2);
  return sum / double(regions_of(frame)[0].size());
}

Motion walking_camera() {
  Motion motion;
  motion.camera = [](uint32_t phase) {
    return glm::dvec3(0.002 * phase - 0.006, 0.0003 * phase, 0.3);
  };
  return motion;
}

constexpr uint32_t reference_periods = 10, reference_samples = 64;
const Way no_reuse = {"none", "reconnection"};

// Expects deviations below 3 sigma over all tests, and a sigma small enough to detect a bias.
void expect_no_bias(const std::vector<std::vector<double>>& found,
                    const std::vector<std::vector<double>>& reference, int tests,
                    const std::string& name) {
  const Judged judged = judge(found, reference);
  std::printf("%-32s %.2f sigma, %.2f %% off, 1 sigma is %.2f %%\n", name.c_str(), judged.worst,
              100 * judged.largest, 100 * judged.spread);
  EXPECT_LT(judged.worst, dermis::restir::testing::three_sigma_limit(
                              static_cast<int>(reference_periods) - 1, tests))
      << name;
  EXPECT_LT(judged.spread, 0.06) << name;
}

TEST_F(ReuseWithRayQueries, MovingCamera_NoBiasWithAnyShift) {
  const Motion motion = walking_camera();
  const auto reference_frames = frames_of(motion, no_reuse, reference_periods, reference_samples);
  ASSERT_EQ(reference_frames.size(), reference_periods * motion.period);
  const auto reference = lights_of(reference_frames, motion, 0, motion.period);
  std::vector<double> last(size_t{side} * side); // The reference of the last frame of a period.
  for (size_t first = 0; first < reference_frames.size(); first += motion.period)
    for (size_t i = 0; i < last.size(); ++i)
      last[i] +=
          luminance(reference_frames[first + motion.period - 1].scattered, i) / reference_periods;

  std::vector<Way> ways = {no_reuse};
  for (const char* shift : {"reconnection", "delayed", "hybrid", "sequential"})
    for (const char* reuse : {"temporal", "spatial", "spatiotemporal"})
      if (quality(0, 1) != 0 || reuse == std::string("spatiotemporal") ||
          shift == std::string("delayed"))
        ways.push_back({reuse, shift});
  const uint32_t periods = quality(10, 40);
  double error_without_reuse = 0;
  for (const Way& way : ways) {
    const auto frames = frames_of(motion, way, periods);
    ASSERT_EQ(frames.size(), periods * motion.period);
    expect_no_bias(lights_of(frames, motion, 0, motion.period), reference,
                   static_cast<int>(5 * ways.size()), way.shift + " " + way.reuse);
    double error = 0;
    for (size_t first = 0; first < frames.size(); first += motion.period)
      error += square_of(frames[first + motion.period - 1], last) / periods;
    if (way.reuse == "none") error_without_reuse = error;
    std::printf("  mse of the last frame %.3g, %.2f of that alone\n", error,
                error / error_without_reuse);
    EXPECT_TRUE(way.reuse != "spatiotemporal" || error < error_without_reuse) << way.shift;
  }
}

// Random numbers belong to the frame, so a frame after a cut equals a frame without history.
TEST_F(ReuseWithRayQueries, Cut_RestartsBitForBit) {
  Motion motion = walking_camera();
  motion.period = 4;
  for (const std::string& shift : shifts()) {
    const auto over_time = frames_of(motion, {"spatiotemporal", shift}, 2);
    const auto within = frames_of(motion, {"spatial", shift}, 2);
    ASSERT_EQ(over_time.size(), 8u);
    ASSERT_EQ(within.size(), 8u);
    EXPECT_TRUE(over_time[4].cut);
    for (const size_t first : {size_t{0}, size_t{4}})
      EXPECT_EQ(over_time[first].scattered.texels, within[first].scattered.texels)
          << shift << ", frame " << first;
    EXPECT_NE(over_time[3].scattered.texels, within[3].scattered.texels) << shift;
  }
}

TEST_F(ReuseWithRayQueries, LightsSwitchedOff_LeaveNoGhost) {
  Motion motion;
  motion.period = 8;
  motion.intensity = [](uint32_t phase) { return phase < 6 ? 0.03 : 0.0; };
  for (const std::string& shift : shifts()) {
    const auto frames = frames_of(motion, {"spatiotemporal", shift}, 1);
    ASSERT_EQ(frames.size(), 8u);
    EXPECT_GT(mean_over(frames[5].scattered, regions_of(frames[5])[0]), 0.01);
    for (const size_t frame : {size_t{6}, size_t{7}})
      EXPECT_EQ(mean_over(frames[frame].scattered, regions_of(frames[frame])[0]), 0)
          << shift << ", frame " << frame;
  }
}

TEST_F(ReuseWithRayQueries, MovedLight_IsFollowedAtOnce) {
  Motion motion;
  motion.light = [](uint32_t phase) {
    return phase < 5 ? glm::dvec3(0.02, 0.03, -0.15) : glm::dvec3(-0.06, -0.05, -0.09);
  };
  const auto reference =
      lights_of(frames_of(motion, no_reuse, reference_periods, reference_samples), motion, 5, 6);
  for (const std::string& shift : shifts())
    expect_no_bias(lights_of(frames_of(motion, {"temporal", shift}, quality(20, 96)), motion, 5, 6),
                   reference, 20, "light jumps, " + shift);
}

TEST_F(ReuseWithRayQueries, MovingObject_NoBias) {
  Motion motion;
  motion.lobe = [](uint32_t phase) { return glm::dvec3(-0.022 + 0.003 * phase, -0.012, 0.012); };
  const auto reference = lights_of(
      frames_of(motion, no_reuse, reference_periods, reference_samples), motion, 0, motion.period);
  for (const std::string& shift : shifts())
    expect_no_bias(lights_of(frames_of(motion, {"spatiotemporal", shift}, quality(10, 40)), motion,
                             0, motion.period),
                   reference, 20, "object moves, " + shift);
}

// Only new paths see that the shield is gone. The history has no such paths, counts for at most
// confidence_cap new paths, and fades with each frame.
TEST_F(ReuseWithRayQueries, RemovedShadow_FadesAsTheCapAllows) {
  constexpr uint32_t shaded = 30, lit = 50;
  Motion motion;
  motion.period = shaded + lit;
  motion.shield = [](uint32_t phase) { return glm::dvec3(0, phase < shaded ? 0 : 5, -0.05); };
  Motion bare;
  bare.period = 1;
  const auto reference = frames_of(bare, no_reuse, reference_periods, reference_samples);
  for (const std::string& shift : shifts()) {
    const auto frames = frames_of(motion, {"temporal", shift}, 1);
    ASSERT_EQ(frames.size(), shaded + lit);
    const auto region = regions_of(frames[0])[2]; // Right of the lobe.
    std::vector<double> lights;
    for (const FrameOutputs& frame : reference)
      lights.push_back(mean_over(frame.scattered, region));
    const double whole = mean_of(lights).mean;
    EXPECT_LT(mean_over(frames[shaded - 1].scattered, region), 0.2 * whole)
        << "the region is shaded";
    double sum = 0;
    constexpr uint32_t last = 10; // Frames that are averaged to reduce the noise.
    for (uint32_t f = lit - last; f < lit; ++f)
      sum += mean_over(frames[shaded + f].scattered, region) / last;
    const double left = std::pow(confidence_cap / (confidence_cap + 1), lit - last);
    std::printf("%s: %.3f of the light is back, the cap lets %.3f be missing\n", shift.c_str(),
                sum / whole, left);
    EXPECT_GT(sum / whole, 1 - left - 0.1) << shift;
    EXPECT_LT(sum / whole, 1.1) << shift;
  }
}

} // namespace
} // namespace demo
