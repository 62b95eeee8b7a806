// Tests invariants of merging.
#include "tests/passes/restir/cpu/reuse.hpp"
#include "tests/passes/restir/triangle_scene.hpp"

#include <gtest/gtest.h>

namespace dermis::restir {
namespace {

struct Merge : ::testing::Test {
  testing::TriangleScene ear = testing::ear_scene();
  Scene scene = ear.access();
  std::vector<testing::Pixel> pixels = testing::look_at(ear, 16, 16);
  Random random{23, 0, 0};

  // Returns a sample of the pixel whose estimate is `light`, with any confidence.
  Reservoir sample_with_estimate(const Domain& domain, double light) {
    while (true) {
      Reservoir r = draw_initial(scene, domain, random);
      if (!has_sample(r)) continue;
      r.weight = light / target_of(scene, domain, r);
      r.confidence = 1 + 19 * random_unit(random);
      return r;
    }
  }
};

TEST_F(Merge, EqualEstimates_AreKept) {
  // The MIS weights of one pixel's domain sum to 1, so the estimate is kept except for rounding.
  constexpr double light = 5;
  int judged = 0;
  for (size_t i = 0; i < pixels.size(); ++i) {
    const Domain& domain = pixels[i].domain;
    if (domain.medium == 0) continue;
    for (const Shift shift : {Shift::reconnection, Shift::delayed, Shift::hybrid}) {
      const ReuseSettings settings{shift, Index::traced, confidence_cap};
      const Reservoir own = sample_with_estimate(domain, light),
                      history = sample_with_estimate(domain, light);
      const Reservoir merged =
          merge_temporal(scene, settings, domain, own, domain, history, random);
      EXPECT_NEAR(luminance(resolve(scene, domain, merged)), light, 1e-6);
      EXPECT_NEAR(merged.confidence, own.confidence + history.confidence, 1e-9);

      const Reservoir others[] = {sample_with_estimate(domain, light),
                                  sample_with_estimate(domain, light),
                                  sample_with_estimate(domain, light)};
      double confidences = 0;
      for (const Reservoir& other : others)
        confidences += other.confidence;
      Spatial spatial = spatial_begin(scene, settings, domain, own, confidences, random);
      for (const Reservoir& other : others)
        spatial_add(scene, settings, domain, spatial, domain, other, random);
      const Reservoir last = spatial_end(spatial, random);
      EXPECT_NEAR(luminance(resolve(scene, domain, last)), light, 1e-6);
      EXPECT_NEAR(last.confidence, own.confidence + confidences, 1e-9);
      ++judged;
    }
  }
  EXPECT_GT(judged, 200);
}

// For a path of a pixel and its image in a neighbour: merging each of them with nothing gives two
// parts that sum to the path's target, because MIS weights sum to 1 for every path.
TEST_F(Merge, CountsEachPathOnce) {
  Reservoir nothing;
  int judged = 0, with_jacobian = 0;
  for (size_t i = 0; i + 2 < pixels.size(); ++i) {
    const Domain &domain = pixels[i].domain, &neighbour = pixels[i + 2].domain;
    if (domain.medium == 0 || neighbour.medium != domain.medium) continue;
    for (const Shift shift : {Shift::reconnection, Shift::delayed, Shift::hybrid}) {
      ReuseSettings settings{shift, Index::traced, confidence_cap};
      Reservoir own = sample_with_estimate(domain, 1);
      own.weight = 1;
      own.confidence = 3;
      const double target = target_of(scene, domain, own);
      const Shifted image = shift_path(scene, shift, domain, neighbour, own);
      if (!(image.target > 0)) continue;
      Reservoir other = image.path;
      other.confidence = 5;
      if (other.hits == 0 && shift != Shift::reconnection)
        prepare(scene, shift, Index::traced, neighbour, other, random);
      other.weight = image.jacobian; // 1 over the Jacobian of the inverse shift.
      Reservoir no_own = nothing, no_other = nothing;
      no_own.confidence = own.confidence;
      no_other.confidence = other.confidence;
      const auto light = [&](const Reservoir& merged) {
        return luminance(resolve(scene, domain, merged));
      };

      const double temporal =
          light(merge_temporal(scene, settings, domain, own, neighbour, no_other, random)) +
          light(merge_temporal(scene, settings, domain, no_own, neighbour, other, random));
      EXPECT_NEAR(temporal / target, 1, 1e-6);
      const auto spatial = [&](const Reservoir& mine, const Reservoir& theirs) {
        Spatial merge = spatial_begin(scene, settings, domain, mine, theirs.confidence, random);
        spatial_add(scene, settings, domain, merge, neighbour, theirs, random);
        return light(spatial_end(merge, random));
      };
      EXPECT_NEAR((spatial(own, no_other) + spatial(no_own, other)) / target, 1, 1e-6);
      with_jacobian += std::abs(image.jacobian - 1) > 0.1;
      ++judged;
    }
  }
  EXPECT_GT(judged, 100);
  EXPECT_GT(with_jacobian, 30);
}

TEST_F(Merge, WithNothingKeepsTheOwnSample) {
  for (const testing::Pixel& pixel : pixels) {
    if (pixel.domain.medium == 0) continue;
    const Reservoir own = sample_with_estimate(pixel.domain, 3);
    const ReuseSettings settings;
    const Reservoir merged =
        merge_temporal(scene, settings, pixel.domain, own, pixel.domain, {}, random);
    EXPECT_NEAR(luminance(resolve(scene, pixel.domain, merged)), 3, 1e-9);
    Spatial without_neighbours = spatial_begin(scene, settings, pixel.domain, own, 0, random);
    EXPECT_NEAR(luminance(resolve(scene, pixel.domain, spatial_end(without_neighbours, random))), 3,
                1e-9);
    break;
  }
}

TEST_F(Merge, CapsTheConfidenceOfHistory) {
  for (const testing::Pixel& pixel : pixels) {
    if (pixel.domain.medium == 0) continue;
    Reservoir own = sample_with_estimate(pixel.domain, 3),
              history = sample_with_estimate(pixel.domain, 3);
    own.confidence = 2;
    for (const double huge : {41.0, 1e6, 1e300, std::numeric_limits<double>::infinity()}) {
      history.confidence = huge;
      const Reservoir merged =
          merge_temporal(scene, {}, pixel.domain, own, pixel.domain, history, random);
      EXPECT_EQ(merged.confidence, 2 + 2 * confidence_cap);
      EXPECT_NEAR(luminance(resolve(scene, pixel.domain, merged)), 3, 1e-9);
    }
    break;
  }
}

} // namespace
} // namespace dermis::restir
