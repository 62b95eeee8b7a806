// Every shift that claims it converges to the reference that shares no sampler. Means of regions over
// independent restarts, 3 sigma over all of them (Bonferroni, Student's t). DERMIS_TESTS_FULL: 64x64 pixels.
#include "passes/subsurface/truth/parallel.hpp"
#include "tests/framegraph/test_tier.hpp"
#include "tests/passes/restir/sequence.hpp"

#include <gtest/gtest.h>

#include <cstdio>

namespace dermis::restir {
namespace {

using testing::Mean;
using testing::Reuse;
using testing::SequenceSettings;
using testing::TriangleScene;

constexpr uint32_t restarts = 32, batches = 32;

uint32_t tier(uint32_t quick, uint32_t full) {
  return static_cast<uint32_t>(dermis::testing::seeds_of_tier(quick, full));
}

std::vector<Mean> means_of(const std::vector<std::vector<double>>& values) {
  std::vector<Mean> means;
  for (const auto& one : values)
    means.push_back(testing::mean_of(one));
  return means;
}

SequenceSettings settings_of(Shift shift, Reuse reuse) {
  SequenceSettings settings;
  settings.shift = shift;
  settings.reuse = reuse;
  settings.width = settings.height = tier(16, 64);
  settings.frames = tier(12, 32);
  if ((static_cast<uint32_t>(reuse) & 1u) != 0)
    settings.jitter = 0.4; // else the history's path is the pixel's own
  return settings;
}

std::vector<Mean> restarted(const TriangleScene& scene, const SequenceSettings& settings,
                            const testing::Regions& regions) {
  std::vector<std::vector<double>> values(regions.pixels.size(), std::vector<double>(restarts));
  subsurface::parallel_for(restarts, 1, 0, [&](size_t restart) {
    const auto result = run_sequence(scene, settings, regions, {}, static_cast<uint32_t>(restart + 1));
    for (size_t r = 0; r < values.size(); ++r)
      values[r][restart] = result.region_mean[r];
  });
  return means_of(values);
}

struct Judged {
  double worst = 0;   // deviation in sigma
  double largest = 0; // relative difference
  double spread = 0;  // relative sigma of the whole picture's difference
};
Judged judge(const std::vector<Mean>& found, const std::vector<Mean>& reference) {
  Judged judged;
  for (size_t r = 0; r < found.size(); ++r) {
    const double level = reference[r].mean;
    judged.worst = std::max(judged.worst, std::abs(deviation(found[r], reference[r])));
    judged.largest = std::max(judged.largest, std::abs(found[r].mean - level) / level);
    judged.spread = std::hypot(found[r].sigma, reference[r].sigma) / level;
  }
  return judged;
}

class Unbiased : public ::testing::Test {
protected:
  void SetUp() override {
    const SequenceSettings settings = settings_of(Shift::reconnection, Reuse::none);
    pixels = look_at(scene, settings.width, settings.height);
    regions = testing::regions_of(pixels);
    reference = means_of(area_reference(scene, pixels, regions, batches, tier(20000, 40000), 99));
    ASSERT_GE(regions.pixels.size(), 5u);
  }

  void expect_no_bias(const SequenceSettings& settings, int tests, const char* name) {
    const auto found = restarted(scene, settings, regions);
    const Judged judged = judge(found, reference);
    std::printf("%-40s %.2f sigma, %.2f %% off, 1 sigma is %.2f %%\n", name, judged.worst,
                100 * judged.largest, 100 * judged.spread);
    EXPECT_LT(judged.worst, testing::three_sigma_limit(restarts - 1, tests)) << name;
    EXPECT_LT(judged.spread, 0.06) << name; // what is seen must be worth seeing
  }

  TriangleScene scene = testing::ear_scene();
  std::vector<testing::Pixel> pixels;
  testing::Regions regions;
  std::vector<Mean> reference;
};

TEST_F(Unbiased, SamplesAlone) {
  expect_no_bias(settings_of(Shift::reconnection, Reuse::none), static_cast<int>(regions.pixels.size()),
                 "none");
}

TEST_F(Unbiased, EveryShiftWithEveryReuse) {
  const int tests = static_cast<int>(regions.pixels.size()) * 12;
  constexpr const char* shifts[] = {"reconnection", "delayed", "hybrid", "sequential"};
  constexpr const char* reuses[] = {"none", "temporal", "spatial", "spatiotemporal"};
  for (const Shift shift : {Shift::reconnection, Shift::delayed, Shift::hybrid, Shift::sequential})
    for (const Reuse reuse : {Reuse::temporal, Reuse::spatial, Reuse::spatiotemporal}) {
      if (shift == Shift::sequential && reuse == Reuse::temporal) continue; // that is reconnection
      const std::string name =
          std::string(shifts[static_cast<size_t>(shift)]) + " " + reuses[static_cast<size_t>(reuse)];
      expect_no_bias(settings_of(shift, reuse), tests, name.c_str());
    }
}

// With drawn indices the sequence of shifts has a bias (supplement, section 6): how much, and that the test
// above would have found a larger one.
TEST_F(Unbiased, NotWhereTheIndexIsDrawn) {
  SequenceSettings settings = settings_of(Shift::sequential, Reuse::spatiotemporal);
  settings.index = Index::drawn;
  const std::vector<Mean> found = restarted(scene, settings, regions);
  const Judged judged = judge(found, reference);
  for (size_t r = 0; r < found.size(); ++r)
    std::printf("region %zu: %+.2f %% +- %.2f\n", r, 100 * (found[r].mean / reference[r].mean - 1),
                100 * std::hypot(found[r].sigma, reference[r].sigma) / reference[r].mean);
  EXPECT_LT(judged.largest, 0.5);
}

} // namespace
} // namespace dermis::restir
