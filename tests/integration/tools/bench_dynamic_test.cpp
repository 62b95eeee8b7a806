// Tests the measures of `dermis bench dynamic`, and that its shipped file is valid.
#include "integration/tools/command/bench/dynamic/accumulation.hpp"
#include "integration/tools/command/bench/dynamic/combined_reference.hpp"
#include "integration/tools/command/bench/dynamic/comparison.hpp"
#include "integration/tools/command/bench/dynamic/dynamic_file.hpp"
#include "integration/tools/command/bench/dynamic/figures.hpp"
#include "integration/tools/command/bench/supplement/experiment.hpp"
#include "integration/tools/files/metrics.hpp"
#include "tests/integration/tools/command_fixture.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <set>

namespace dermis::tools {
namespace {

const std::string root = DERMIS_SOURCE_DIR;

TEST(BenchDynamic, ShippedFileIsValidAndNamesExistingFiles) {
  Diagnostics diagnostics;
  const auto file = read_dynamic(root + "/tests/benchmark/dynamic.json", diagnostics);
  ASSERT_TRUE(file.has_value());
  std::set<std::string> scenes, guidance;
  for (const SequenceRequest& scene : file->scenes) {
    EXPECT_TRUE(std::filesystem::exists(root + "/" + scene.file)) << scene.file;
    EXPECT_GT(scene.frames, file->counted) << scene.scene;
    scenes.insert(scene.scene);
  }
  for (const DynamicTechnique& technique : file->techniques) {
    EXPECT_TRUE(std::filesystem::exists(root + "/" + technique.graph)) << technique.graph;
    guidance.insert(technique.guidance);
  }
  for (const char* scene : {"flashing", "regular", "dynamic", "pan", "dolly", "cut", "strobe"})
    EXPECT_TRUE(scenes.contains(scene)) << scene;
  for (const char* one : {"none", "conf", "spvg", "ccv", "ocv", "ocv_seed", "split_half"})
    EXPECT_TRUE(guidance.contains(one)) << one;
}

TEST(BenchDynamic, DistancesFileIsValidAndHasCameras) {
  Diagnostics diagnostics;
  const auto file = read_dynamic(root + "/tests/benchmark/distances.json", diagnostics);
  ASSERT_TRUE(file.has_value());
  for (const SequenceRequest& scene : file->scenes)
    EXPECT_TRUE(scene.camera.has_value()) << scene.framing;
  std::set<std::string> techniques;
  for (const DynamicTechnique& technique : file->techniques)
    techniques.insert(technique.technique);
  for (const char* one : {"afis", "separable", "fixed"}) // slides 43 and 45
    EXPECT_TRUE(techniques.contains(one)) << one;
}

TEST(BenchDynamic, GuidanceFileIsValidAndJitters) {
  Diagnostics diagnostics;
  const auto file = read_dynamic(root + "/tests/benchmark/guidance.json", diagnostics);
  ASSERT_TRUE(file.has_value());
  uint32_t jittered = 0;
  for (const SequenceRequest& scene : file->scenes) {
    EXPECT_GT(scene.frames, file->counted) << scene.framing;
    // Frames under jitter show other points, so that their pixels cannot be compared.
    EXPECT_FALSE(scene.jitter && scene.still) << scene.framing;
    jittered += scene.jitter ? 1 : 0;
  }
  EXPECT_EQ(jittered, 1u);
}

TEST(BenchDynamic, PublishedTable_HasMaximaAndFixed) {
  const auto row = [](const char* technique, const char* guidance, std::vector<double> spp,
                      std::vector<double> psnr_db) {
    DynamicRow one{"regular", "close", 4, {{technique, "n=16", "", {}, false, {}}, guidance, 8}};
    one.mean_spp = spp.front();
    one.spp = std::move(spp);
    one.figures.psnr_db = std::move(psnr_db); // the first frame is not counted
    return one;
  };
  const std::vector<DynamicRow> rows = {row("afis", "spvg", {20, 60}, {1, 50, 50}),
                                        row("afis", "ccv", {10, 15}, {1, 45, 51}),
                                        row("fixed", "none", {16, 16}, {1, 47, 47})};
  Report report;
  add_published(report, rows);
  const auto number = [&](size_t row_index, std::string_view column) {
    for (size_t i = 0; i < report.more.columns.size(); ++i)
      if (report.more.columns[i].key == column)
        return std::get<double>(
            static_cast<const ReportVariant&>(report.more.rows.at(row_index)[i]));
    return -1.0;
  };
  ASSERT_EQ(report.more.rows.size(), 3u); // AS, AS+CCV, fixed
  EXPECT_DOUBLE_EQ(number(1, "their_max_ratio"), 4.0);
  EXPECT_DOUBLE_EQ(number(1, "our_max_ratio"), 4.0);          // 60 / 15
  EXPECT_DOUBLE_EQ(number(1, "our_max_db_ratio"), 45. / 50.); // farther from 1 than 51 / 50
  EXPECT_DOUBLE_EQ(number(2, "our_spp"), 16);
}

TEST(BenchDynamic, UnknownEntry_IsRejectedWithThePlace) {
  Diagnostics diagnostics;
  EXPECT_FALSE(read_dynamic(root + "/tests/benchmark/shapes.json", diagnostics));
  EXPECT_TRUE(diagnostics.has_errors());
}

// Two grey pixels per frame.
FrameLight grey(double found_a, double found_b, double reference_a, double reference_b) {
  return {{found_a, found_a, found_a, found_b, found_b, found_b},
          {reference_a, reference_a, reference_a, reference_b, reference_b, reference_b}};
}

TEST(BenchDynamic, ConstantError_IsNoFlicker) {
  const std::vector<FrameLight> frames(10, grey(0.5, 0.6, 0.4, 0.5));
  const SequenceFigures figures = sequence_figures(frames, 2, true, 1);
  EXPECT_NEAR(figures.psnr_db_frame, 20, 1e-9); // 0.1 of 1
  EXPECT_NEAR(figures.psnr_db_accumulated, 20, 1e-9);
  EXPECT_EQ(figures.flicker, 0);
  EXPECT_EQ(figures.psnr_db.size(), 10u);
  // Exposed.
  EXPECT_NEAR(sequence_figures(frames, 2, true, 2).psnr_db_frame, 20 - 20 * std::log10(2), 1e-9);
}

TEST(BenchDynamic, NotANumber_IsAnInfiniteError) {
  std::vector<FrameLight> frames(10, grey(0.5, 0.6, 0.4, 0.5));
  frames[5].found[2] = std::numeric_limits<double>::quiet_NaN();
  for (const bool still : {true, false}) {
    const SequenceFigures figures = sequence_figures(frames, 2, still, 1);
    EXPECT_EQ(figures.psnr_db_frame, -std::numeric_limits<double>::infinity());
    EXPECT_EQ(figures.psnr_db[5], -std::numeric_limits<double>::infinity());
    EXPECT_NEAR(figures.psnr_db[4], 20, 1e-9);
  }
  EXPECT_EQ(psnr_from_mse(std::numeric_limits<double>::quiet_NaN()),
            -std::numeric_limits<double>::infinity());
}

TEST(BenchDynamic, AlternatingError_FlickersByTwiceItsSize) {
  std::vector<FrameLight> frames;
  for (int t = 0; t < 200; ++t)
    frames.push_back(grey(0.5 + (t % 2 == 0 ? 0.01 : -0.01), 0.5, 0.5, 0.5));
  const SequenceFigures figures = sequence_figures(frames, 100, true, 1);
  EXPECT_NEAR(figures.flicker, 0.02 / std::sqrt(2), 1e-9); // One of two pixels.
  EXPECT_GT(figures.psnr_db_accumulated, figures.psnr_db_frame + 20);
}

TEST(BenchDynamic, AccumulatedLight_IsComparedWithTheReference) {
  std::vector<FrameLight> frames(4, grey(0.5, 0.5, 0.4, 0.4));
  for (FrameLight& frame : frames)
    frame.accumulated = grey(0.41, 0.41, 0, 0).found;
  const SequenceFigures figures = sequence_figures(frames, 1, false, 1);
  EXPECT_NEAR(figures.psnr_db_accumulated, 40, 1e-9); // 0.01 of 1
  EXPECT_NEAR(figures.psnr_db_frame, 20, 1e-9);
  EXPECT_EQ(figures.flicker, 0);
}

CapturedFrame square_of_light() {
  constexpr uint32_t side = 16;
  CapturedFrame frame;
  frame.description.width = frame.description.height = side;
  frame.description.render = {0, 0, side, side};
  frame.description.perspective = false;
  auto& m = frame.description.clip_from_view; // 0.1 m from side to side.
  m = {20, 0, 0, 0, 0, -20, 0, 0, 0, 0, -0.1, 0, 0, 0, 0, 1};
  frame.description.previous_clip_from_view = m;
  frame.description.view_from_world =
      frame.description.previous_view_from_world = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  frame.depth = Image::sized(side, side, 1);
  std::fill(frame.depth.values.begin(), frame.depth.values.end(), 1.0f);
  frame.velocity = Image::sized(side, side, 2);
  frame.profile.assign(size_t{side} * side, 1);
  return frame;
}

TEST(BenchDynamic, LightIsAccumulatedAlongMovingSurfaces) {
  constexpr uint32_t side = 16;
  CapturedFrame frame = square_of_light();
  for (size_t i = 0; i < frame.velocity.values.size(); i += 2)
    frame.velocity.values[i] = 1; // One pixel to the right in each frame.
  Accumulation accumulation;
  for (uint32_t t = 0; t < 6; ++t) {
    std::vector<float> light(size_t{3} * side * side);
    for (uint32_t y = 0; y < side; ++y)
      for (uint32_t x = 0; x < side; ++x)
        for (uint32_t c = 0; c < 3; ++c)
          // Fixed to the surface.
          light[3 * (size_t{y} * side + x) + c] = static_cast<float>(x + 100 - t);
    const auto& mean = accumulation.add(frame, light, t > 0);
    for (uint32_t x = 0; x < side; ++x) {
      EXPECT_NEAR(mean[5 * side + x].light[0], x + 100 - t, 1e-9) << x << " in frame " << t;
      EXPECT_NEAR(mean[5 * side + x].count, std::min(x, t) + 1, 1e-9) << x << " in frame " << t;
    }
  }
  // A frame without a predecessor has no history.
  const std::vector<float> dark(size_t{3} * side * side, 0.0f);
  EXPECT_EQ(accumulation.add(frame, dark, false)[5 * side + 8].light[0], 0);
}

TEST(BenchDynamic, SumOfLights_ReferenceIsTheSum) {
  Session quiet;
  quiet.quiet = true;
  CapturedFrame frame = square_of_light();
  frame.velocity = {};
  ASSERT_TRUE(complete_projection(frame.description, frame.rays));
  subsurface::Profile profile;
  profile.d_mm = {4, 2, 1};
  frame.description.profiles.push_back({1, profile});
  frame.lighting = Image::sized(16, 16, 3);
  const auto light = [&](float first, float second) {
    for (size_t i = 0; i < frame.lighting.values.size(); ++i)
      frame.lighting.values[i] = first * float(i % 7) + second * float(i / 3 % 5);
  };
  KnownReferences known;
  light(1, 0);
  ASSERT_TRUE(make_reference_of_still(quiet, frame, "truth", 64, "", known));
  light(0.5f, 2);
  ASSERT_TRUE(make_reference_of_still(quiet, frame, "truth", 64, "", known));
  EXPECT_EQ(known.known.size(), 2u);
  light(3, 0.25f);
  const auto combined = make_reference_of_still(quiet, frame, "truth", 64, "", known);
  const auto computed = make_reference(quiet, frame, "truth", 64, "");
  ASSERT_TRUE(combined && computed);
  EXPECT_EQ(known.known.size(), 2u); // No new reference was computed.
  ASSERT_EQ(combined->pixels, computed->pixels);
  for (size_t i = 0; i < computed->light.size(); ++i)
    EXPECT_NEAR(combined->light[i], computed->light[i], 1e-5 * 20); // Floats, for light up to 20.
  // A pixel that is not a sum of known light needs a new reference.
  frame.lighting.values[300] += 1;
  ASSERT_TRUE(make_reference_of_still(quiet, frame, "truth", 64, "", known));
  EXPECT_EQ(known.known.size(), 3u);
}

TEST(BenchDynamic, ChangingReference_IsNoFlicker) {
  std::vector<FrameLight> frames;
  for (int t = 0; t < 40; ++t) {
    const double light = 0.5 + 0.4 * std::sin(0.5 * t);
    frames.push_back(grey(light, light, light, light));
  }
  const SequenceFigures figures = sequence_figures(frames, 5, true, 1);
  EXPECT_EQ(figures.flicker, 0);
  EXPECT_EQ(figures.psnr_db_frame, 100);
}

TEST(BenchSupplement, BestWeightMatchesTheClosedForm) {
  EXPECT_EQ(run_supplement(true, 7), run_supplement(true, 7));
  EXPECT_NE(run_supplement(true, 7), run_supplement(true, 8));
  // The standard error at 100,000 samples is 0.00033 (numerics of the project's notes, section A);
  // the bound is three of them.
  EXPECT_NEAR(sampled_control_weight(false, 100000, 3), best_control_weight(false), 1e-3);
}

} // namespace
} // namespace dermis::tools

namespace dermis::test {
namespace {

class BenchDynamicCommand : public CommandTest {};

TEST_F(BenchDynamicCommand, NeedsMoreFramesThanItSkips) {
  EXPECT_THAT(run({"bench", "dynamic", "--scenes", "flashing", "--frames", "20"}),
              FailsWith(2, "flashing close has 20 frames"));
}

TEST_F(BenchDynamicCommand, UnknownNames_AreRejected) {
  EXPECT_THAT(run({"bench", "dynamic", "--scenes", "flashing,flashin"}),
              FailsWith(2, "--scenes: unknown 'flashin'; available: ", "flashing"));
  EXPECT_THAT(run({"bench", "dynamic", "--framings", "close,far"}),
              FailsWith(2, "--framings: unknown 'far'; available: close"));
}

} // namespace
} // namespace dermis::test
