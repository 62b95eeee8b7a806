// Tests what a budget chooses if light passes through thin parts: rays, if the device has them,
// with the reason in the report.
#include "tests/integration/examples/demo_engine/ray_queries.hpp"
#include "tests/support/test_folder.hpp"
#include "tests/support/text_file.hpp"

#include <algorithm>
#include <fstream>

namespace demo {
namespace {

using dermis::test::read_text;
using dermis::test::replaced;
using dermis::test::TestFolder;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

enum class LightFrom { behind, front };

// The ear of configs/scenes/back_lit_ear.json, lit from behind or from the front. Frames are
// seconds apart, so no switch has to wait.
RenderOptions ear(const TestFolder& folder, LightFrom from, double budget_ms) {
  std::string scene = read_text(source + "/configs/scenes/back_lit_ear.json");
  scene = replaced(scene, R"("frames_per_second": 25)", R"("frames_per_second": 1)");
  scene = replaced(scene, "../profiles/skin.json", "skin.json");
  if (from == LightFrom::front)
    scene = replaced(scene, "[-0.05, 0.05, -0.20]", "[-0.05, 0.05, 0.20]");
  const std::filesystem::path path = folder / "ear.json";
  std::ofstream(path) << scene;
  std::filesystem::copy_file(source + "/configs/profiles/skin.json", folder / "skin.json",
                             std::filesystem::copy_options::overwrite_existing);
  RenderOptions options = by_rays(path.string(), 48, 5, {});
  options.budget.ms = budget_ms;
  return options;
}

constexpr double plenty_ms = 60000; // Enough for a software driver on a busy machine.

TEST(WithoutRayQueries, BudgetHasNoRays_TheReportSaysWhy) {
  const TestFolder folder;
  const Rendering rendering = rendered(ear(folder, LightFrom::behind, plenty_ms));
  ASSERT_EQ(rendering.frames.size(), 5u);
  // The first frame is chosen before anything was counted; one of the other frames uses rays.
  if (std::any_of(rendering.frames.begin(), rendering.frames.end(),
                  [](const FrameOutputs& frame) { return ran(frame, "sample_paths"); }))
    GTEST_SKIP() << "this device has ray queries";
  EXPECT_THAT(rendering.warnings,
              testing::Contains(HasSubstr("does not offer 'restir': the device lacks ray_query")));
  const FrameChoice& choice = rendering.frames.back().choice.value();
  EXPECT_EQ(choice.configurations, 1u);
  EXPECT_EQ(choice.technique, "sap smooth");
  EXPECT_GT(choice.transmitted_rms, 0.05) << "transmission is counted anyway";
  EXPECT_GT(choice.predicted_rmse, 0.5 * choice.transmitted_rms) << "and reported as an error";
}

TEST_F(WithRayQueries, BackLight_TheBudgetBuysRays) {
  const TestFolder folder;
  const Rendering rendering = rendered(ear(folder, LightFrom::behind, plenty_ms));
  ASSERT_EQ(rendering.frames.size(), 5u);
  const FrameChoice& choice = rendering.frames.back().choice.value();
  EXPECT_EQ(choice.configuration, "technique=restir");
  EXPECT_THAT(choice.why, HasSubstr("considering transmitted light"));
  EXPECT_GT(choice.transmitted_rms, 0.05);
  EXPECT_TRUE(ran(rendering.frames.back(), "sample_paths"));
  EXPECT_FALSE(ran(rendering.frames.back(), "gather"));
  EXPECT_NE(rendering.frames[0].choice->configuration, choice.configuration)
      << "no transmission is known before the first count";
}

TEST_F(WithRayQueries, FrontLight_TheBudgetBuysNoRays) {
  const TestFolder folder;
  const Rendering rendering = rendered(ear(folder, LightFrom::front, plenty_ms));
  ASSERT_EQ(rendering.frames.size(), 5u);
  const FrameChoice& choice = rendering.frames.back().choice.value();
  EXPECT_EQ(choice.configurations, 2u);
  EXPECT_EQ(choice.configuration, "technique=sap");
  EXPECT_THAT(choice.why,
              AllOf(HasSubstr("least error within the budget"), Not(HasSubstr("transmitted"))));
  EXPECT_LT(choice.transmitted_rms, 0.05);
}

TEST_F(WithRayQueries, TooSmallBudget_ReportsTheMissingTime) {
  const TestFolder folder;
  RenderOptions options = ear(folder, LightFrom::behind, 0);
  options.budget.deterministic = true; // Equal on every machine.
  options.budget.ms = 20;
  // Rays cost more than the budget; passes without a line cost as much per group as the last line.
  options.budget.calibration = {"invented",
                                R"({ "dermis_calibration": 2, "device": "invented", "costs": [
    { "work": "restir.initial", "base_us": 30000, "group_us": 0, "spread": 0 },
    { "work": "others", "base_us": 0, "group_us": 0.001, "spread": 0 } ] })"};
  const Rendering rendering = rendered(options);
  ASSERT_EQ(rendering.frames.size(), 5u);
  const FrameChoice& choice = rendering.frames.back().choice.value();
  EXPECT_EQ(choice.configuration, "technique=sap");
  EXPECT_EQ(choice.next_better, "technique=restir");
  EXPECT_GT(choice.next_better_missing_ms, 0);
}

} // namespace
} // namespace demo
