// Properties of sampling: means, their bias, and the decrease of errors with the number of samples.
#include "tests/properties/noise.hpp"

#include <algorithm>
#include <cmath>

namespace {

using namespace properties;

class Sampler : public DeviceTest {};

TEST_F(Sampler, MeanIsTheReferenceAtEveryPixel) {
  const double z_square = expect_the_reference_in_the_mean(
      "fixed", {{"samples", "4"}, {"normalise", "\"none\""}, {"inverse", "\"exact\""}});
  EXPECT_NEAR(z_square, 1, 0.36); // Three sd.
}

TEST_F(Sampler, OwnDensityIsUnbiased_PublishedChoicesAreNot) {
  const Plane plane = noisy_plane(40, 0.5);
  const std::vector<double> reference = unnormalised_reference(plane);
  const auto bias = [&](const char* inverse, const char* weighting, const char* direct) {
    return bias_of("fixed", plane, reference,
                   {{"samples", "8"},
                    {"normalise", "\"none\""},
                    {"inverse", inverse},
                    {"weighting", weighting},
                    {"direct", direct}},
                   64);
  };
  for (const char* inverse : {"\"polynomial\"", "\"exact\"", "\"approximate\""})
    for (const char* direct : {"\"inscribed\"", "\"none\""}) {
      const Bias one = bias(inverse, "\"sampler\"", direct);
      EXPECT_LT(std::abs(one.sigmas), 3.5) << inverse << " " << direct << ": " << one.fraction;
    }
  const Bias radius = bias("\"exact\"", "\"sampler\"", "\"circumscribed\"");
  // The neighbours' part of the corners becomes own light.
  EXPECT_GT(radius.sigmas, 10) << radius.fraction;
  EXPECT_GT(radius.fraction, 0.01);
}

TEST_F(Sampler, SelfNormalisationBiasFallsWithTheSamples) {
  // In a narrow channel weights vary, so the ratio of two means is biased by about their covariance
  // over n.
  const Plane plane = noisy_plane(48, 4.0);
  const std::vector<double> reference = normalised_reference(plane);
  double before = 1, first = 0;
  for (const char* samples : {"4", "16", "64"}) {
    const Bias one =
        bias_of("fixed", plane, reference, {{"samples", samples}, {"direct", "\"none\""}}, 64, 2);
    RecordProperty(std::string("share_at_") + samples, std::to_string(one.fraction));
    RecordProperty(std::string("sigmas_at_") + samples, std::to_string(one.sigmas));
    EXPECT_LT(std::abs(one.fraction), before) << samples << " samples";
    before = std::abs(one.fraction);
    if (first == 0) first = before;
  }
  EXPECT_LT(before, 0.15 * first); // 1/16 is expected.
}

TEST_F(Sampler, ErrorFallsFasterThanForIndependentSamples) {
  // Independent samples: n^-0.5. R2 on light with edges: about n^-0.7 over 8 to 64.
  Plane plane{.width = 192, .height = 192, .d_px = {3, 3, 3}};
  plane.light = [](double x, double y) {
    return (x < 96 ? 0.2f : 0.8f) + (std::hypot(x - 60, y - 80) < 25 ? 0.2f : 0.0f);
  };
  std::vector<double> logs;
  std::vector<float> reference;
  {
    const Picture many = run("fixed", plane, {{"samples", "4096"}});
    reference = many.rgb;
  }
  for (const char* samples : {"8", "16", "32", "64"}) {
    const Picture picture = run("fixed", plane, {{"samples", samples}});
    double squares = 0;
    for (size_t i = 0; i < reference.size(); i += 3)
      squares += std::pow(double(picture.rgb[i]) - double(reference[i]), 2);
    logs.push_back(0.5 * std::log2(squares / double(reference.size() / 3)));
  }
  // Least squares over four points one octave apart.
  const double slope = (3 * (logs[3] - logs[0]) + (logs[2] - logs[1])) / 10;
  RecordProperty("slope", std::to_string(slope));
  // Regression bounds of the present implementation.
  EXPECT_LT(slope, -0.6);
  EXPECT_GT(slope, -0.9);
}

// Samples cover the same surface in the middle of a wide view and near its corners, where rays are
// 46 degrees off the axis.
TEST_F(Sampler, PerspectiveViewsKeepTheMass) {
  Plane plane{.width = 64, .height = 64, .pixel_pitch_m = 2.0 / 64, .d_px = {0.6, 0.6, 0.6}};
  plane.perspective = true;
  struct Block {
    uint32_t x, y;
    double mean = 0;
  };
  Block blocks[] = {{30, 30}, {6, 30}, {30, 54}, {6, 6}, {54, 54}};
  constexpr uint32_t side = 4, frames = 16;
  run_frames("fixed", plane,
             {{"samples", "64"}, {"normalise", "\"none\""}, {"inverse", "\"exact\""}}, frames,
             [&](const Picture& picture) {
               for (Block& block : blocks)
                 for (uint32_t i = 0; i < side * side; ++i)
                   block.mean += picture.at(block.x + i % side, block.y + i / side, 1) /
                                 (double(side) * side * frames);
             });
  for (const Block& block : blocks)
    EXPECT_NEAR(block.mean, 1, 0.02) << block.x << ", " << block.y;
}

// At coordinates near 2048 small offsets round to none, so that samples hit their own centre.
TEST_F(Sampler, OffsetsThatRoundToNone_HaveFiniteWeights) {
  constexpr uint32_t side = 2048;
  Plane plane{.width = side, .height = side, .d_px = {0.5, 0.5, 0.5}};
  plane.profile = [](int x, int y) { return uint8_t{x >= 1984 && y >= 1984}; };
  float maximum = 0;
  run_frames("fixed", plane, {{"samples", "16"}, {"normalise", "\"none\""}, {"direct", "\"none\""}},
             4, [&](const Picture& picture) {
               for (const float value : picture.rgb)
                 maximum = std::max(maximum, value);
             });
  EXPECT_GT(maximum, 1);
  EXPECT_LT(maximum, 20);
}

} // namespace
