// Tests the seeded family of scenes, and `dermis bench error-time --family`.
#include "integration/tools/command/bench/error_time/pictures.hpp"
#include "integration/tools/command/bench/family/family.hpp"
#include "integration/tools/command/bench/kept_values.hpp"
#include "integration/tools/command/bench/pattern.hpp"
#include "integration/tools/command/run/reference_run.hpp"
#include "integration/tools/files/capture_reference.hpp"
#include "tests/integration/tools/command_fixture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace dermis::tools {
namespace {

using namespace dermis::test;

constexpr uint32_t width = 96, height = 54;

CapturedFrame frame_of(const FamilyScene& scene) {
  subsurface::Profile skin;
  skin.name = "skin";
  skin.dmfp_mm = {3.673, 1.367, 0.6827};
  skin.albedo = {0.44, 0.22, 0.13};
  subsurface::derive(skin);
  return generate_family_scene(scene, width, height, skin);
}

uint64_t hash_of(const CapturedFrame& frame) {
  Hash hash;
  hash.add(frame.lighting.values);
  hash.add(frame.depth.values);
  hash.add(frame.profile);
  hash.add(std::vector<double>{frame.rays.scale_x, frame.rays.scale_y});
  return hash.value;
}

// Returns the mean of all values with random weights; libraries differ in the last bits of sin and
// exp, which hardly change the result.
double checksum(const CapturedFrame& frame) {
  double sum = 0;
  for (uint32_t i = 0; i < frame.profile.size(); ++i)
    sum += double(hashed(i, 0)) * double(frame.lighting.values[size_t{3} * i]) +
           double(hashed(i, 1)) * double(frame.depth.values[i]) +
           double(hashed(i, 2)) * double(frame.profile[i]);
  return sum / double(frame.profile.size());
}

TEST(Family, HasFiftyScenesInTwoHalves) {
  std::map<std::string, int> halves;
  std::set<std::string> names, classes;
  for (const FamilyScene& scene : family_scenes()) {
    ++halves[scene.member.half];
    EXPECT_TRUE(names.insert(scene.name).second) << scene.name;
    classes.insert(scene.member.scene_class);
  }
  EXPECT_THAT(halves, ::testing::ElementsAre(::testing::Pair("judging", ::testing::Ge(50)),
                                             ::testing::Pair("tuning", ::testing::Ge(50))));
  EXPECT_THAT(classes,
              ::testing::IsSupersetOf({"plane",   "tilt",    "bumps",  "sphere",      "step",
                                       "fold",    "groove",  "wave",   "plate",       "strip",
                                       "checker", "stripes", "random", "dither",      "hair",
                                       "strand",  "hole",    "thin",   "perspective", "pixels"}));
}

TEST(Family, GenerationIsRepeatableAndScenesDiffer) {
  std::set<uint64_t> hashes;
  for (const FamilyScene& scene : family_scenes()) {
    const uint64_t hash = hash_of(frame_of(scene));
    EXPECT_EQ(hash, hash_of(frame_of(scene))) << scene.name;
    EXPECT_TRUE(hashes.insert(hash).second) << scene.name << " equals another scene";
  }
}

TEST(Family, JudgingParametersDifferFromTuned) {
  std::set<std::string> tuned;
  for (const FamilyScene& scene : family_scenes()) {
    const std::string text =
        fmt::format("{} {} {}", scene.member.scene_class, scene.parameters(), scene.d_px);
    if (scene.member.half == "tuning") {
      tuned.insert(text);
    } else {
      EXPECT_FALSE(tuned.contains(text)) << scene.name;
    }
  }
}

TEST(Family, FramesAreValidAndHaveTheRequestedD) {
  for (const FamilyScene& scene : family_scenes()) {
    const CapturedFrame frame = frame_of(scene);
    const ReferenceFrame reference = make_reference_frame(frame);
    ASSERT_GE(subsurface_pixels(frame.profile), 64u) << scene.name;
    for (const float light : frame.lighting.values)
      ASSERT_TRUE(std::isfinite(light) && light >= 0 && light <= 1.001f) << scene.name;
    for (size_t i = 0; i < frame.profile.size(); ++i)
      ASSERT_TRUE(frame.profile[i] == 0 || frame.depth.values[i] > 0) << scene.name;
    EXPECT_NEAR(frame.rays.scale_x / -frame.rays.scale_y, scene.aspect, 1e-9) << scene.name;
    EXPECT_EQ(frame.rays.perspective, scene.perspective) << scene.name;
    if (!scene.perspective && frame.description.profiles.size() == 1) {
      EXPECT_NEAR(median_d_px(reference.input()), scene.d_px, 1e-5 * scene.d_px) << scene.name;
    }
  }
}

// The documents and the limits of tests state errors of these scenes.
TEST(Family, NamedScenesKeepTheirContents) {
  const std::map<std::string, double> expected = {
      {"zigzag_56_d6", 1.2755844}, {"grooves_d4", 1.2767158},   {"hair_d4", 1.2762041},
      {"checker_1_d2", 1.5273428}, {"dithered_5cm", 1.2700589}, {"pixels_bands_2to1", 1.2739859},
      {"zigzag_j1", 1.1562478}};
  size_t found = 0;
  for (const FamilyScene& scene : family_scenes())
    if (const auto known = expected.find(scene.name); known != expected.end()) {
      ++found;
      EXPECT_NEAR(checksum(frame_of(scene)), known->second, 1e-6) << scene.name;
    }
  EXPECT_EQ(found, expected.size());
}

TEST(PairedRatio, IntervalHoldsTheRatio) {
  Reference reference;
  std::vector<float> twice, once;
  for (uint32_t i = 0; i < 400; ++i) {
    reference.pixels.push_back(i);
    const double noise = double((i * 7919) % 101) / 101;
    for (int c = 0; c < 3; ++c) {
      reference.light.push_back(0.5);
      once.push_back(static_cast<float>(0.5 + 0.01 * noise));
      twice.push_back(static_cast<float>(0.5 + 0.02 * noise * (i % 2 == 0 ? 1 : 0.9)));
    }
  }
  reference.population = 4000;
  const auto found = paired_ratio(twice, once, reference);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->ratio, 1.9, 0.05);
  EXPECT_LT(found->low, found->ratio);
  EXPECT_GT(found->high, found->ratio);
  // Errors of both pictures are large at equal pixels, so that the interval is narrow.
  EXPECT_LT(found->high - found->low, 0.05);
  reference.everywhere = true;
  EXPECT_EQ(paired_ratio(twice, once, reference)->low, found->ratio);
  EXPECT_FALSE(paired_ratio(twice, std::vector<float>(once.size(), 0.5f), reference));
}

class BenchFamily : public CommandTest {
protected:
  std::vector<std::string> arguments(std::vector<std::string> more) const {
    more.insert(more.begin(),
                {"bench", "error-time", "--family", "--quick", "--cache", path("cache")});
    return more;
  }
};

TEST_F(BenchFamily, ReportsBothHalvesAndEqualPictures) {
  ASSERT_THAT(run(arguments({"--write-captures", path("captures")})), Succeeds());
  ASSERT_THAT(run({"apply", "--frames", path("captures"), "--graph",
                   "configs/graphs/separable.json", "--out", path("pictures")}),
              Succeeds());
  const auto outcome = run(arguments(
      {"--techniques", "separable", "--pictures", path("pictures"), "--json", path("out.json")}));
  ASSERT_THAT(outcome,
              Succeeds("geometric means", "tuning", "judging", "separable taps=25 / pict"));
  const std::string json = read("out.json");
  ASSERT_TRUE(is_json(json));
  // The same program wrote the pictures.
  EXPECT_THAT(json, HasAll(R"("class": "fold")", R"("half": "judging")", R"("half": "tuning")",
                           R"("scene": "geometric mean")", R"("class": "all")",
                           R"("pictures_ratio": 1,)"));
}

TEST_F(BenchFamily, InvalidUse_IsReported) {
  EXPECT_THAT(run(arguments({"--techniques", "separable", "--scenes", "step", "--write-captures",
                             path("captures")})),
              FailsWith(2, "--write-captures needs all scenes"));
  EXPECT_THAT(run(arguments({"--techniques", "separable", "--scenes", "step", "--pictures",
                             path("nowhere")})),
              FailsWith(1, "frame_0", "scattered.exr"));
}

} // namespace
} // namespace dermis::tools
