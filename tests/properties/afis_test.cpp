// Properties of filtered importance sampling: means, cost and benefit of mips, borders, and
// sequences over frames.
#include "tests/properties/noise.hpp"

#include <cmath>

namespace {

using namespace properties;

Settings quoted(std::vector<std::pair<std::string, std::string>> settings) {
  for (auto& [name, value] : settings)
    if (value.find_first_of("0123456789") == std::string::npos) value = "\"" + value + "\"";
  return settings;
}

class Afis : public DeviceTest {};

TEST_F(Afis, WithoutMips_MeanIsTheReferenceAtEveryPixel) {
  for (const char* channels : {"widest", "mixture"}) {
    const auto run_with = [&](const char* sequence, const char* direct) {
      return expect_the_reference_in_the_mean("afis", quoted({{"samples", "4"},
                                                              {"mips", "none"},
                                                              {"estimator", "none"},
                                                              {"channels", channels},
                                                              {"direct", direct},
                                                              {"sequence", sequence}}));
    };
    EXPECT_NEAR(run_with("hashed", "none"), 1, 0.36) << channels; // Three sd.
    // 256 points of one sequence are closer than random points. Regression bounds of the present
    // implementation.
    EXPECT_LT(run_with("continued", "none"), 0.85) << channels;
    EXPECT_LT(run_with("stratified", "none"), 0.85) << channels;
    // With the pixel's own light taken exactly, noise is lower, and the reference's sub-points (8 x
    // 8 per pixel) begin to show. Regression bound of the present implementation.
    EXPECT_LT(run_with("hashed", "inscribed"), 1.6) << channels;
  }
}

Settings noise_settings(const char* mips) {
  return quoted(
      {{"samples", "8"}, {"sequence", "hashed"}, {"estimator", "centred"}, {"mips", mips}});
}

TEST_F(Afis, Mips_AddBiasAndReduceTheError) {
  const Plane plane = noisy_plane(96, 3);
  const std::vector<double> reference = normalised_reference(plane);
  const Bias without = bias_of("afis", plane, reference, noise_settings("none"), 32);
  for (const char* mips : {"trilinear", "whole"}) {
    const Bias with = bias_of("afis", plane, reference, noise_settings(mips), 32);
    RecordProperty(std::string("rms_") + mips, std::to_string(with.rms));
    RecordProperty(std::string("share_") + mips, std::to_string(with.fraction));
    EXPECT_GT(std::abs(with.sigmas), 10) << mips << ": " << with.fraction;
    // Regression bound of the present implementation.
    EXPECT_LT(with.rms, 0.7 * without.rms) << mips;
  }
  RecordProperty("rms_none", std::to_string(without.rms));
}

// A step with a disc on it.
Plane step_and_disc() {
  Plane plane{.width = 144, .height = 144, .d_px = {3, 3, 3}};
  plane.light = [](double x, double y) {
    return (x < 72 ? 0.2f : 0.8f) + (std::hypot(x - 50, y - 80) < 25 ? 0.2f : 0.0f);
  };
  return plane;
}

double rms_difference(const std::vector<float>& a, const std::vector<float>& b) {
  double squares = 0;
  for (size_t i = 0; i < a.size(); i += 3)
    squares += std::pow(double(a[i]) - double(b[i]), 2);
  return std::sqrt(squares / double(a.size() / 3));
}

TEST_F(Afis, ErrorFallsFasterThanForIndependentSamples) {
  const Plane plane = step_and_disc();
  const std::vector<float> reference = run("fixed", plane, {{"samples", "2048"}}).rgb;
  for (const char* sequence : {"continued", "stratified"}) {
    std::vector<double> logs;
    for (const char* samples : {"8", "16", "32", "64"}) {
      const Picture picture =
          run("afis", plane, quoted({{"samples", samples}, {"sequence", sequence}}));
      logs.push_back(std::log2(rms_difference(picture.rgb, reference)));
    }
    // Least squares over four points one octave apart.
    const double slope = (3 * (logs[3] - logs[0]) + (logs[2] - logs[1])) / 10;
    RecordProperty(std::string("slope_") + sequence, std::to_string(slope));
    RecordProperty(std::string("rms_16_") + sequence, std::to_string(std::exp2(logs[1])));
    // Regression bounds of the present implementation.
    EXPECT_LT(slope, -0.55) << sequence;
    EXPECT_GT(slope, -1.2) << sequence;
  }
}

TEST_F(Afis, ContinuedSequence_AveragesBetter) {
  const Plane plane = step_and_disc();
  const std::vector<float> reference = run("fixed", plane, {{"samples", "2048"}}).rgb;
  const auto error = [&](const char* sequence) {
    std::vector<float> mean;
    run_frames("afis", plane,
               quoted({{"samples", "8"}, {"lod_bias", "-1.5"}, {"sequence", sequence}}), 40,
               [&](const Picture& picture) {
                 if (mean.empty()) mean = picture.rgb;
                 for (size_t i = 0; i < mean.size(); ++i)
                   mean[i] += 0.1f * (picture.rgb[i] - mean[i]);
               });
    return rms_difference(mean, reference);
  };
  const double hashed = error("hashed"), continued = error("continued"),
               stratified = error("stratified");
  RecordProperty("hashed", std::to_string(hashed));
  RecordProperty("continued", std::to_string(continued));
  RecordProperty("stratified", std::to_string(stratified));
  // Regression bounds of the present implementation.
  EXPECT_LT(continued, 0.85 * hashed);
  EXPECT_LT(stratified, 0.85 * hashed);
}

TEST_F(Afis, WhiteLightStaysWhiteWithEverySetting) {
  Plane plane{.width = 96, .height = 70};
  plane.profile = [](int x, int y) {
    return uint8_t(std::hypot(x - 40, y - 30) < 25 ? 0 : 1 + (x > 70));
  };
  plane.depth_m = [](int x, int) { return x < 20 ? 1.0f : 1.02f; };
  const auto expect_white = [&](const char* graph, const Settings& settings) {
    const Picture picture = run(graph, plane, settings);
    for (const float value : picture.rgb)
      ASSERT_NEAR(value, 1, 1e-3) << graph << " " << settings.front().second;
  };
  for (const char* estimator : {"self", "centred"})
    for (const char* channels : {"widest", "mixture"})
      for (const char* mips : {"trilinear", "whole", "none"})
        expect_white("afis",
                     quoted({{"estimator", estimator}, {"channels", channels}, {"mips", mips}}));
  expect_white("afis_seed", {{"samples", "16"}});
}

TEST_F(Afis, NoLevelLeaksIntoOtherProfiles) {
  Plane plane{.width = 128, .height = 128, .d_px = {8, 4, 2}};
  plane.profile = [](int x, int y) { return uint8_t(x + y / 3 < 80 ? 1 : 2); };
  plane.light = [](double x, double y) { return int(x) + int(y) / 3 < 80 ? 1.0f : 0.0f; };
  for (const char* samples : {"4", "16"}) {
    const Picture picture = run("afis", plane, quoted({{"samples", samples}, {"lod_bias", "0.5"}}));
    for (uint32_t y = 0; y < plane.height; ++y)
      for (uint32_t x = 0; x < plane.width; ++x)
        for (uint32_t c = 0; c < 3; ++c)
          ASSERT_NEAR(picture.at(x, y, c), double(plane.light(x, y)), 1e-3) << x << " " << y;
  }
}

TEST_F(Afis, NoScattering_ReturnsTheLightExactly) {
  Plane plane = noisy_plane(64, 4);
  plane.d_px = {4, 0, 0};
  for (const char* channels : {"widest", "mixture"}) {
    const Picture picture = run("afis", plane, quoted({{"channels", channels}}));
    for (uint32_t y = 0; y < plane.height; ++y)
      for (uint32_t x = 0; x < plane.width; ++x)
        for (uint32_t c = 1; c < 3; ++c)
          ASSERT_EQ(picture.at(x, y, c), double(noise(x, y))) << channels;
  }
  plane.scatter_scale = [](int, int) { return 1e-30f; };
  const Picture picture = run("afis", plane, {});
  for (uint32_t y = 0; y < plane.height; ++y)
    for (uint32_t x = 0; x < plane.width; ++x)
      ASSERT_EQ(picture.at(x, y, 0), double(noise(x, y)));
}

} // namespace
