// Every unbiased shift converges to a reference with an independent sampler. Region means over
// independent restarts are within 3 sigma over all comparisons (Bonferroni, Student's t).
// DERMIS_TESTS_FULL uses 24x24 pixels.
#include "passes/common/reference/parallel.hpp"
#include "tests/framegraph/test_scale.hpp"
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

uint32_t quality(uint32_t quick, uint32_t full) {
  return static_cast<uint32_t>(dermis::testing::seeds_to_try(quick, full));
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
  settings.width = settings.height = quality(16, 24);
  settings.frames = quality(12, 8); // Frames are independent.
  if ((static_cast<uint32_t>(reuse) & 1u) != 0) {
    // More frames than the confidence cap lets a history count for.
    settings.frames = quality(12, 32);
    settings.jitter = 0.4; // Without jitter the history's path is the pixel's own path.
  }
  return settings;
}

std::vector<Mean> restarted(const TriangleScene& scene, const SequenceSettings& settings,
                            const testing::Regions& regions) {
  std::vector<std::vector<double>> values(regions.pixels.size(), std::vector<double>(restarts));
  subsurface::parallel_for(restarts, 1, 0, [&](size_t restart) {
    const auto result =
        run_sequence(scene, settings, regions, {}, static_cast<uint32_t>(restart + 1));
    for (size_t r = 0; r < values.size(); ++r)
      values[r][restart] = result.region_mean[r];
  });
  return means_of(values);
}

struct Judged {
  double worst = 0;   // Deviation in sigma.
  double largest = 0; // Relative difference.
  double spread = 0;  // Relative sigma of the difference of the whole picture.
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
    reference =
        means_of(area_reference(scene, pixels, regions, batches, quality(20000, 10000), 99));
    ASSERT_GE(regions.pixels.size(), 5u);
  }

  void expect_no_bias(const SequenceSettings& settings, int tests, const char* name) {
    const auto found = restarted(scene, settings, regions);
    const Judged judged = judge(found, reference);
    std::printf("%-40s %.2f sigma, %.2f %% off, 1 sigma is %.2f %%\n", name, judged.worst,
                100 * judged.largest, 100 * judged.spread);
    EXPECT_LT(judged.worst, testing::three_sigma_limit(restarts - 1, tests)) << name;
    EXPECT_LT(judged.spread, 0.06) << name; // The test has to be sensitive enough.
  }

  TriangleScene scene = testing::ear_scene();
  std::vector<testing::Pixel> pixels;
  testing::Regions regions;
  std::vector<Mean> reference;
};

TEST_F(Unbiased, SamplesWithoutReuse) {
  expect_no_bias(settings_of(Shift::reconnection, Reuse::none),
                 static_cast<int>(regions.pixels.size()), "none");
}

TEST_F(Unbiased, EveryShiftWithEveryReuse) {
  const int tests = static_cast<int>(regions.pixels.size()) * 12;
  constexpr const char* shifts[] = {"reconnection", "delayed", "hybrid", "sequential"};
  constexpr const char* reuses[] = {"none", "temporal", "spatial", "spatiotemporal"};
  for (const Shift shift : {Shift::reconnection, Shift::delayed, Shift::hybrid, Shift::sequential})
    for (const Reuse reuse : {Reuse::temporal, Reuse::spatial, Reuse::spatiotemporal}) {
      // Equal to reconnection.
      if (shift == Shift::sequential && reuse == Reuse::temporal) continue;
      const std::string name = std::string(shifts[static_cast<size_t>(shift)]) + " " +
                               reuses[static_cast<size_t>(reuse)];
      expect_no_bias(settings_of(shift, reuse), tests, name.c_str());
    }
}

// In the first frame after lights moved, one of them to the other side, the result has only the
// light of the new positions.
TEST_F(Unbiased, InTheFrameAfterLightsMoved) {
  TriangleScene after = scene;
  after.lights[0].position = {2.6, 1, 4};
  after.lights[0].emission = {2, 6, 20};
  after.lights[1].emission = {8, 4, 2};
  testing::finish(after);
  const auto moved = means_of(area_reference(after, pixels, regions, batches, 20000, 97));
  const int tests = static_cast<int>(regions.pixels.size()) * 3;
  for (const Shift shift : {Shift::reconnection, Shift::delayed, Shift::hybrid}) {
    SequenceSettings settings = settings_of(shift, Reuse::spatiotemporal);
    settings.judged_from = 8;
    settings.frames = 9;
    constexpr uint32_t changes = 96; // Each has one checked frame.
    std::vector<std::vector<double>> values(regions.pixels.size(), std::vector<double>(changes));
    subsurface::parallel_for(changes, 1, 0, [&](size_t i) {
      const auto result =
          run_sequence(scene, settings, regions, {}, static_cast<uint32_t>(i + 301), after.lights);
      for (size_t r = 0; r < values.size(); ++r)
        values[r][i] = result.region_mean[r];
    });
    const Judged judged = judge(means_of(values), moved);
    std::printf("lights moved, shift %u: %.2f sigma, %.2f %% off, 1 sigma is %.2f %%\n",
                static_cast<unsigned>(shift), judged.worst, 100 * judged.largest,
                100 * judged.spread);
    EXPECT_LT(judged.worst, testing::three_sigma_limit(restarts - 1, tests));
  }
}

// With sampled indices the sequential shift has a bias (supplement, section 6). The test prints the
// bias and bounds it.
TEST_F(Unbiased, SampledIndices_BiasIsSmall) {
  SequenceSettings settings = settings_of(Shift::sequential, Reuse::spatiotemporal);
  settings.index = Index::sampled;
  const std::vector<Mean> found = restarted(scene, settings, regions);
  for (size_t r = 0; r < found.size(); ++r)
    std::printf("region %zu: %+.2f %%, 1 sigma is %.2f %%\n", r,
                100 * (found[r].mean / reference[r].mean - 1),
                100 * std::hypot(found[r].sigma, reference[r].sigma) / reference[r].mean);
  EXPECT_LT(judge(found, reference).largest, 0.25);
}

// Mean square error of a frame late in the sequence, over pixels and restarts.
TEST_F(Unbiased, Reuse_ReducesTheError) {
  testing::Regions each;
  std::vector<double> light(pixels.size());
  for (uint32_t i = 0; i < pixels.size(); ++i)
    if (pixels[i].domain.medium != 0) each.pixels.push_back({i});
  const auto means = means_of(area_reference(scene, pixels, each, batches, 20000, 98));
  for (size_t r = 0; r < each.pixels.size(); ++r)
    light[each.pixels[r][0]] = means[r].mean;
  const auto error = [&](Shift shift, Reuse reuse) {
    SequenceSettings settings = settings_of(shift, reuse);
    settings.frames = 13;
    std::vector<double> squares(16);
    subsurface::parallel_for(squares.size(), 1, 0, [&](size_t restart) {
      squares[restart] =
          run_sequence(scene, settings, regions, light, static_cast<uint32_t>(restart + 101))
              .last_square;
    });
    return testing::mean_of(squares).mean;
  };
  const double none = error(Shift::reconnection, Reuse::none);
  double parts[4] = {};
  for (const Shift shift :
       {Shift::reconnection, Shift::delayed, Shift::hybrid, Shift::sequential}) {
    const double spatial = error(shift, Reuse::spatial), both = error(shift, Reuse::spatiotemporal);
    std::printf("shift %u: mse %.4f alone, %.4f spatial, %.4f spatiotemporal\n",
                static_cast<unsigned>(shift), none, spatial, both);
    EXPECT_LT(spatial, none);
    EXPECT_LT(both, spatial);
    parts[static_cast<size_t>(shift)] = both;
  }
  EXPECT_LT(parts[3],
            // The sequential shift must be at least as good as the worse of its parts.
            1.1 * std::max(parts[0], parts[1]));
}

} // namespace
} // namespace dermis::restir
