// Tests choices by budget on the command line: render, calibrate, bench budget.
#include "tests/framegraph/test_scale.hpp"
#include "tests/integration/tools/command_fixture.hpp"

#include <nlohmann/json.hpp>

namespace dermis::test {
namespace {

using nlohmann::json;

constexpr const char* graph = "configs/graphs/skin.json";
constexpr const char* scene = "configs/scenes/bust.json";

struct Choice : CommandTest {};

TEST_F(Choice, FramesReportExpectedAndMeasured) {
  const Outcome outcome =
      run({"render", scene, "--graph", graph, "--size", "64x36", "--frames", "4", "--subset", "0",
           "--budget", "1000", "--deterministic", "--out", path("out"), "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json answer = json::parse(outcome.out);
  ASSERT_EQ(answer["choices"].size(), 4u);
  for (const json& frame : answer["choices"]) {
    // A second is enough for the smallest error: samples for all tiles, until tiles were counted
    // and none requested samples.
    EXPECT_THAT(frame["technique"].get<std::string>(),
                ::testing::AnyOf("hybrid smooth", "sap base"));
    EXPECT_EQ(frame["budget_ms"], 1000);
    EXPECT_GT(frame["measured_ms"], 0);
    EXPECT_GT(frame["calibrated_ms"], 0);
    EXPECT_EQ(frame["view_tiles"], 8 * 5);
    EXPECT_GT(frame["scattering_tiles"], 0);
  }
}

TEST_F(Choice, TextOutputIsASentence) {
  ASSERT_THAT(
      run({"render", scene, "--graph", graph, "--size", "64x36", "--frames", "2", "--subset", "0",
           "--budget", "0.001", "--deterministic", "--out", path("out")}),
      Succeeds("frame 1: technique=off", "budget 0.00; RMSE",
               "(no configuration fits the budget: the fastest runs); next better technique="));
}

TEST_F(Choice, CalibrateWritesAFileForValidateAndRender) {
  const std::string file = path("calibration.json");
  const std::string overlay = write("few.json", techniques_alone);
  ASSERT_THAT(run({"calibrate", graph, "--overlay", overlay, "--size", "64x36", "--frames", "2",
                   "--out", file}),
              Succeeds("holds the costs of"));
  EXPECT_THAT(run({"validate", file}), Succeeds("calibration, no problems"));
  EXPECT_THAT(run({"render", scene, "--graph", graph, "--size", "64x36", "--frames", "2",
                   "--subset", "0", "--calibration", file, "--budget", "5", "--out", path("out")}),
              Succeeds());
}

TEST_F(Choice, InvalidCalibration_IsRejectedWithItsPlace) {
  const std::string file = write(
      "calibration.json", "{ \"dermis_calibration\": 2,\n \"devise\": \"d\", \"costs\": [] }");
  EXPECT_THAT(run({"render", scene, "--graph", graph, "--size", "64x36", "--frames", "1",
                   "--subset", "0", "--calibration", file, "--out", path("out")}),
              FailsWith(1, "2:2", "did you mean 'device'?"));
}

TEST_F(Choice, ExplainDescribesAFrame) {
  const Outcome outcome = run({"explain", "configs/graphs/papers/hybrid.json", "--frame", "--size",
                               "64x36", "--budget", "1000", "--deterministic"});
  ASSERT_THAT(outcome, Succeeds("frame 5: "));
  // d is 0.2 px: no tile requests samples at this size.
  EXPECT_THAT(outcome.out, HasAll("ms predicted", "budget 1000.00"));
  EXPECT_EQ(run({"explain", graph, "--budget", "2"}).exit_code, 2); // The frame is missing.
}

TEST_F(Choice, ExplainListsTheFrontierOfAFrame) {
  const std::vector<std::string> line = {"explain", graph,   "--frame",
                                         "--size",  "64x36", "--deterministic"};
  const Outcome text = run(line);
  ASSERT_THAT(text, Succeeds("configuration", "at percentile", "technique=off", "  dominated\n"));
  std::vector<std::string> with_json = line;
  with_json.insert(with_json.end(), {"--budget", "0.01", "--json"});
  const Outcome outcome = run(with_json);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json frontier = json::parse(outcome.out)[0]["frontier"];
  ASSERT_GE(frontier.size(), 9u);
  double before = 0, least = 1;
  for (const json& one : frontier) {
    EXPECT_GE(one["expected_ms"], before);
    before = one["expected_ms"];
    EXPECT_EQ(one["fits"], false);
    EXPECT_GT(one["transient_bytes"], 0);
    if (one["dominated"] == false) {
      EXPECT_LT(one["expected_rmse"], least) << one["configuration"];
      least = one["expected_rmse"];
    }
  }
}

TEST_F(Choice, HistoriesAreReportedWithAgeAndReason) {
  constexpr const char* residual = "configs/graphs/papers/sap_residual.json";
  ASSERT_THAT(
      run({"explain", residual, "--frame", "--size", "64x36"}),
      Succeeds(::testing::ContainsRegex("\nratio +6 frames +valid since its first frame\n")));
  const Outcome outcome =
      run({"render", "configs/scenes/bust.json", "--graph", residual, "--size", "64x36", "--frames",
           "3", "--subset", "0", "--out", path("out"), "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  uint32_t age = 0;
  const json answer = json::parse(outcome.out);
  for (const json& frame : answer["choices"]) {
    const json& histories = frame["histories"];
    ASSERT_EQ(histories.size(), 2u);
    for (const json& one : histories) {
      EXPECT_THAT(one["name"].get<std::string>(), ::testing::AnyOf("ratio", "place"));
      EXPECT_EQ(one["valid"], true);
      EXPECT_EQ(one["age"], age + 1);
      EXPECT_EQ(one["why"], "valid since its first frame");
    }
    ++age;
  }
  const Outcome without = run({"explain", "configs/graphs/sap.json", "--frame", "--size", "64x36"});
  EXPECT_THAT(without.out, Not(HasSubstr("valid since")));
}

TEST_F(Choice, ExplainCountsReadsByTileClass) {
  const Outcome outcome = run({"explain", "configs/graphs/papers/hybrid_afis_separable.json",
                               "--frame", "--size", "64x36", "--set", "taps=11", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const json frame = json::parse(outcome.out)[0];
  const json& classes = frame["tile_classes"];
  ASSERT_EQ(classes.size(), 4u);
  double sum = frame["reads_per_view"].get<double>();
  uint64_t tiles = 0;
  for (const json& one : classes) {
    sum += 64 * one["tiles"].get<double>() * one["reads_per_pixel"].get<double>();
    tiles += one["tiles"].get<uint64_t>();
  }
  EXPECT_NEAR(frame["reads"].get<double>(), sum, 1e-6 * sum); // T'(n) = sum of w S(m) + O(n)
  EXPECT_EQ(tiles, frame["scattering_tiles"].get<uint64_t>());
  const double each = frame["reads_per_sample"];
  for (size_t k = 2; k < 4; ++k) { // S(m) grows by M(d) per sample.
    const double more = classes[k]["reads_per_pixel"].get<double>() -
                        classes[k - 1]["reads_per_pixel"].get<double>();
    EXPECT_NEAR(more,
                each *
                    (classes[k]["samples"].get<double>() - classes[k - 1]["samples"].get<double>()),
                1e-3);
  }
  EXPECT_EQ(classes[1]["samples"], 16);
}

TEST_F(Choice, BenchSkipGivesARowForEachCase) {
  DERMIS_FULL_TESTS_ONLY(); // BenchAll runs it, too.
  const std::string file = path("skip.json");
  ASSERT_THAT(run({"bench", "skip", "--size", "48x27", "--repetitions", "1", "--json", file}),
              Succeeds("no_material"));
}

TEST_F(Choice, BenchBudgetGivesARowForEachSceneAndBudget) {
  DERMIS_FULL_TESTS_ONLY(); // BudgetJudge tests the evaluation without a device.
  const std::string file = path("budget.json");
  ASSERT_THAT(run({"bench", "budget", "--size", "48x27", "--frames", "4", "--scenes", "flashing",
                   "--repetitions", "1", "--cache", "", "--json", file}),
              Succeeds());
}

TEST_F(Choice, BenchBudgetChecksAllScenesFirst) {
  EXPECT_THAT(run({"bench", "budget", "--scenes", "flashing,no_such_scene"}),
              FailsWith(2, "there is no scene 'no_such_scene'"));
  EXPECT_THAT(run({"bench", "budget", "--scenes", "flashing,head"}),
              FailsWith(2, "scene head: no model is given (--head FOLDER)"));
}

} // namespace
} // namespace dermis::test
