// Samples must not make the pyramid's pictures worse: where its confidence is high they are not
// taken, and elsewhere they weigh as much as their variance allows. On small generated scenes, at
// rest, with real histories.
#include "tests/passes/sap/confidence_scenes.hpp"
#include "tests/properties/plane.hpp"

#include "passes/common/reference/reference.hpp"

#include <algorithm>
#include <cmath>

namespace {

using namespace properties;
namespace subsurface = dermis::subsurface;
constexpr uint32_t refined_width = confidence_scenes::width,
                   refined_height = confidence_scenes::height;

// A scene, and the reference at a part of its pixels.
struct JudgedScene {
  Plane plane;
  std::vector<uint32_t> pixels;
  std::vector<double> reference; // 3 per pixel of `pixels`.

  explicit JudgedScene(const confidence_scenes::Scene& scene) {
    plane.width = refined_width;
    plane.height = refined_height;
    plane.d_px = {scene.d_px, scene.d_px, scene.d_px};
    plane.light = [](double x, double y) {
      return confidence_scenes::light(uint32_t(x), uint32_t(y));
    };
    plane.profile = scene.profile;
    plane.depth_m = scene.depth_m;
    std::vector<float> light, depth;
    std::vector<uint8_t> profile;
    for (uint32_t y = 0; y < refined_height; ++y)
      for (uint32_t x = 0; x < refined_width; ++x) {
        light.insert(light.end(), 3, confidence_scenes::light(x, y));
        depth.push_back(scene.depth_m(int(x), int(y)));
        profile.push_back(scene.profile(int(x), int(y)));
        // One pixel of each 4x2 pixels, at a position that varies.
        const float place = confidence_scenes::hashed(x / 4 + 500, y / 2);
        const bool picked = uint32_t(place * 8) == (y % 2) * 4 + x % 4;
        if (picked && profile.back() != 0) pixels.push_back(y * refined_width + x);
      }
    const double d = scene.d_px * 1e-3;
    const std::vector<subsurface::PerChannel> d_m = {{0, 0, 0}, {d, d, d}, {d, d, d}};
    reference = subsurface::reference_at(
        {refined_width,
         refined_height,
         subsurface::orthographic_rays(refined_width, refined_height, 1e-3),
         light,
         depth,
         profile,
         {},
         d_m},
        pixels, {});
  }
  double rmse(const Picture& picture) const {
    double squares = 0;
    for (size_t i = 0; i < pixels.size(); ++i) {
      const double error = double(picture.rgb[3 * size_t{pixels[i]}]) - reference[3 * i];
      squares += error * error;
    }
    return std::sqrt(squares / double(pixels.size()));
  }
};

class Refined : public DeviceTest {};

// A technique, how many frames its history takes, and the limit of its geometric mean relative to
// `sap`.
struct Refinement {
  const char* graph;
  uint32_t frames;
  double max_mean;
  std::string_view exception = ""; // The limit of this scene is 1.05.
  double logs = 0;
};

// Returns the RMSE of the first and of the newest of several frames at rest.
std::pair<double, double> errors_of(const Refinement& refinement, const JudgedScene& judged) {
  double first = -1, newest = 0;
  run_frames(refinement.graph, judged.plane, {}, refinement.frames, [&](const Picture& picture) {
    newest = judged.rmse(picture);
    if (first < 0) first = newest;
  });
  return {first, newest};
}

// Compares with the RMSE of `sap` on every scene: at most 1.02 of it, 1.05 in the first of several
// frames. Measured means: 0.9945, 0.984 and 0.848.
TEST_F(Refined, SamplesAreNeverWorseThanThePyramid) {
  Refinement refinements[] = {{"sap_blend", 1, 0.995, "zigzag_56"}, // 1.0202
                              {"hybrid", 1, 0.995},
                              {"sap_residual", 32, 0.85}};
  auto scenes = confidence_scenes::all();
  std::erase_if(scenes, [](const auto& scene) { return !scene.refined; });
  for (const auto& scene : scenes) {
    const JudgedScene judged(scene);
    const double sap = judged.rmse(run("sap", judged.plane, {}));
    for (Refinement& refinement : refinements) {
      SCOPED_TRACE(std::string(refinement.graph) + " on " + scene.name);
      const auto [first, newest] = errors_of(refinement, judged);
      const double ratio = newest / sap;
      EXPECT_LE(first / sap, 1.05) << "first frame";
      EXPECT_LE(ratio, scene.name == refinement.exception ? 1.05 : 1.02);
      RecordProperty(std::string(refinement.graph) + " " + scene.name, std::to_string(ratio));
      refinement.logs += std::log(ratio);
    }
  }
  for (const Refinement& refinement : refinements) {
    const double mean = std::exp(refinement.logs / double(scenes.size()));
    EXPECT_LE(mean, refinement.max_mean) << refinement.graph;
    RecordProperty(std::string(refinement.graph) + " mean", std::to_string(mean));
  }
}

// Samples are noisy where two surfaces are mixed and the pyramid is nearly right. Regression bounds
// of the present implementation; without the comparison with noise: 1.59 and 3.29.
TEST_F(Refined, NoiseIsHeldBackWhereSurfacesMix) {
  for (const auto& scene : confidence_scenes::all()) {
    const double limit = scene.name == "grooves" ? 1.2 : scene.name == "dither" ? 1.5 : 0;
    if (limit == 0) continue;
    const JudgedScene judged(scene);
    const double sap = judged.rmse(run("sap", judged.plane, {}));
    const double ratio = errors_of({"sap_residual", 32, 1}, judged).second / sap;
    RecordProperty(scene.name, std::to_string(ratio));
    EXPECT_LE(ratio, limit) << scene.name;
  }
}

// A sample of a frame is a ratio of two random sums, with a bias where only a part of the kernel is
// on the surface. A mean of ratios with equal weights keeps this bias: 1.053 times the error of
// `sap`; measured 0.991.
TEST_F(Refined, OneSampleAFrame_MakesHairNoWorse) {
  const auto scenes = confidence_scenes::all();
  const auto hair = std::ranges::find(scenes, "hair", [](const auto& one) { return one.name; });
  ASSERT_NE(hair, scenes.end());
  const JudgedScene judged(*hair);
  double newest = 0;
  run_frames("sap_residual", judged.plane, {{"samples", "1"}}, 64,
             [&](const Picture& picture) { newest = judged.rmse(picture); });
  EXPECT_LT(newest, judged.rmse(run("sap", judged.plane, {})));
}

// Grooves, on whose sides the pyramid is unsure.
Plane grooves(uint32_t width, uint32_t height, int first_column = 0) {
  Plane plane{.width = width, .height = height};
  plane.light = [](double x, double y) {
    return confidence_scenes::light(uint32_t(x), uint32_t(y));
  };
  plane.depth_m = [](int, int y) { return y / 6 % 2 == 0 ? 1.0f : 1.012f; };
  plane.profile = [=](int x, int) { return uint8_t(x >= first_column ? 1 : 0); };
  return plane;
}

std::vector<Picture> frames_of(const char* graph, const Plane& plane, uint32_t frames) {
  std::vector<Picture> pictures;
  run_frames(graph, plane, {}, frames,
             [&](const Picture& picture) { pictures.push_back(picture); });
  return pictures;
}

// Hosts may number the frames of several views together. Each tile still takes its turn.
TEST_F(Refined, FrameIndices_MayAdvanceByAnyNumber) {
  Plane plane = grooves(64, 64);
  const std::vector<Picture> expected = frames_of("sap_residual", plane, 8);
  plane.frame_step = 2;
  const std::vector<Picture> found = frames_of("sap_residual", plane, 8);
  ASSERT_EQ(found.size(), expected.size());
  for (size_t i = 0; i < found.size(); ++i)
    EXPECT_EQ(found[i].rgb, expected[i].rgb) << i;
}

// Frames after a cut do not depend on the number of frames before it.
TEST_F(Refined, Cut_StartsTheSequenceAgain) {
  Plane plane = grooves(64, 64);
  plane.cut_frame = 4;
  const std::vector<Picture> found = frames_of("sap_residual", plane, 6);
  ASSERT_EQ(found.size(), 6u);
  for (size_t i = 0; i < 3; ++i)
    EXPECT_EQ(found[i + 3].rgb, found[i].rgb) << i;
}

// The change of light is measured in a part of the tiles of a large view, here in every second one,
// which must not be a column without subsurface.
TEST_F(Refined, LargeViews_AreSampledInAllColumns) {
  const Plane plane = grooves(16, 8192, 8);
  const std::vector<Picture> plain = frames_of("sap", plane, 1),
                             refined = frames_of("sap_residual", plane, 3);
  ASSERT_EQ(refined.size(), 3u);
  float largest = 0;
  for (size_t i = 0; i < plain.front().rgb.size(); ++i)
    largest = std::max(largest, std::abs(refined.back().rgb[i] - plain.front().rgb[i]));
  EXPECT_GT(largest, 0.002f); // 0 if no change of light is measured
}

} // namespace
