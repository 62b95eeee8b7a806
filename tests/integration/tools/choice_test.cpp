// Tests choices by budget on the command line: render, calibrate, bench budget.
#include "tests/framegraph/test_scale.hpp"
#include "tests/integration/tools/command_fixture.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <map>

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
    // A second is enough for the smallest error. At d = 0.2 px these techniques are about equal.
    EXPECT_THAT(frame["technique"].get<std::string>(),
                ::testing::AnyOf("afis over frames", "hybrid smooth", "hybrid base", "sap base",
                                 "separable 11"));
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
      Succeeds("frame 1: technique=off", "budget 0.00; expected RMSE",
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
  RunOptions options;
  options.input = read_text(burley);
  EXPECT_THAT(run({"calibrate", "-", "--size", "64x36", "--frames", "2", "--out", file}, options),
              Succeeds("holds the costs of <stdin>"));
}

TEST_F(Choice, EmptyCalibration_IsRejected) {
  const std::string file = write("empty.json", "");
  for (const char* verb : {"calibrate", "bench"})
    EXPECT_THAT(verb == std::string("bench")
                    ? run({"bench", "budget", "--calibration", file, "--size", "64x36"})
                    : run({"calibrate", burley, "--calibration", file, "--out", path("out.json")}),
                FailsWith(1, "is empty"));
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

// Rising budgets select configurations of falling error. A configuration that no budget selects is
// dominated.
TEST_F(Choice, RisingBudgetsFollowTheFrontOfTimeAndError) {
  const Outcome outcome = run({"explain", graph, "--choices", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  const json answer = json::parse(outcome.out);
  ASSERT_EQ(answer["tables"].size(), 3u * 5u); // classes of devices, and distances d
  for (const json& table : answer["tables"]) {
    SCOPED_TRACE(table["device"].get<std::string>() + ", d " + table["d_px"].dump());
    std::map<double, double> rmse_by_budget;
    for (const json& one : table["configurations"]) {
      const json& selected = one["selected_from_ms"];
      if (selected.is_null())
        EXPECT_NE(one["better"], "") << one.dump();
      else
        rmse_by_budget[selected.get<double>()] = one["first_rmse"].get<double>();
    }
    double before = 1;
    for (const auto& [budget_ms, rmse] : rmse_by_budget) {
      EXPECT_LE(rmse, before) << budget_ms;
      before = rmse;
    }
    EXPECT_GE(rmse_by_budget.size(), 3u);
  }
}

TEST_F(Choice, MemoryIsListedPerPlanAndView) {
  const json answer = json::parse(run({"explain", graph, "--choices", "--json"}).out);
  uint64_t largest = 0, transients = 0, histories = 0;
  for (const json& plan : answer["plans"]) {
    const auto transient = plan["transient_bytes"].get<uint64_t>(),
               history = plan["history_bytes"].get<uint64_t>();
    largest = std::max(largest, transient + history);
    transients = std::max(transients, transient);
    histories += history;
  }
  // Only one plan runs in a frame, and no two plans have the same history.
  const uint64_t view =
      answer["transient_bytes"].get<uint64_t>() + answer["history_bytes"].get<uint64_t>();
  EXPECT_GE(view, largest);
  EXPECT_LE(view, largest + largest / 100); // alignment
  EXPECT_LT(view, transients + histories);
  EXPECT_GT(histories, 0u);
}

// Adds separable to afis.json as the other option of a choice.
constexpr const char* or_separable = R"({ "dermis_overlay": 2, "edits": [
  { "set": "/settings/technique", "to": { "choice": ["afis", "separable"], "by": "budget",
    "default": "afis" } },
  { "set": "/resources/separable_light", "to": { "format": "rgba16f", "size": "view" } },
  { "set": "/resources/view_depth", "to": { "format": "r32f", "size": "view" } },
  { "set": "/resources/blurred", "to": { "format": "rgba16f", "size": "view" } },
  { "set": "/passes/scatter/when", "to": "technique == 'afis'" },
  { "insert_before": "export_scattered", "passes": [
    { "pass": "separable_setup", "type": "subsurface.separable_setup",
      "when": "technique == 'separable'",
      "read": { "lighting": "lighting", "material": "material", "depth": "depth",
        "albedo": "albedo", "classes": "classes" },
      "write": { "light": "separable_light", "view_depth": "view_depth" } },
    { "pass": "horizontal", "type": "subsurface.separable", "when": "technique == 'separable'",
      "read": { "light": "separable_light", "view_depth": "view_depth", "tiles": "tiles",
        "arguments": "arguments" },
      "write": { "scattered": "blurred" }, "set": { "axis": "horizontal", "taps": "25" } },
    { "pass": "vertical", "type": "subsurface.separable", "when": "technique == 'separable'",
      "read": { "light": "separable_light", "blurred": "blurred", "view_depth": "view_depth",
        "tiles": "tiles", "arguments": "arguments" },
      "write": { "scattered": "scattered" }, "set": { "axis": "vertical", "taps": "25" } } ] }
        ] })";

// An error table in which afis has less error than separable.
constexpr const char* afis_is_better =
    R"({ "dermis_errors": 2, "scenes": "invented", "unscattered": [[1, 0.05]],
  "techniques": [
    { "name": "afis", "pass_types": [{ "type": "subsurface.afis", "set": {} }],
      "rmse": [[1, 0.002]] },
    { "name": "separable", "pass_types": [{ "type": "subsurface.separable", "set": {} }],
      "rmse": [[1, 0.005]] } ] })";

constexpr const char* afis_takes_more = R"({ "dermis_calibration": 2, "device": "invented",
  "costs": [
    { "work": "subsurface.afis samples=16", "base_us": 10000, "group_us": 0, "spread": 0 },
    { "work": "subsurface.separable taps=25", "base_us": 1000, "group_us": 0, "spread": 0 },
    { "work": "subsurface.classify texturing=post", "base_us": 10, "group_us": 0,
      "spread": 0 } ] })";

TEST_F(Choice, ErrorsOfAFileDecideBetweenAfisAndSeparable) {
  const std::string overlay = write("overlay.json", or_separable);
  const std::string table = write("errors.json", afis_is_better);
  const std::string costs = write("calibration.json", afis_takes_more);
  const auto chosen = [&](const char* budget) {
    const Outcome outcome =
        run({"render",        scene,   "--graph",         "configs/graphs/papers/afis.json",
             "--overlay",     overlay, "--errors",        table,
             "--calibration", costs,   "--size",          "64x36",
             "--frames",      "3",     "--subset",        "0",
             "--budget",      budget,  "--deterministic", "--out",
             path("out"),     "--json"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return json::parse(outcome.out)["choices"].back()["configuration"].get<std::string>();
  };
  EXPECT_EQ(chosen("500"), "technique=afis");
  EXPECT_EQ(chosen("30"), "technique=separable");
}

// With the built-in tables, 64 samples have less error than separable at wide d, and take more
// time.
TEST_F(Choice, AfisIsSelectedWhereItErrsLessAndFits) {
  const Outcome outcome =
      run({"explain", "configs/graphs/papers/afis.json", "--overlay",
           write("overlay.json", or_separable), "--set", "samples=64", "--choices", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  int judged = 0;
  const json answer = json::parse(outcome.out);
  for (const json& table : answer["tables"]) {
    if (table["d_px"] != 8) continue;
    ++judged;
    const json& all = table["configurations"]; // by rising time
    ASSERT_EQ(all.size(), 2u);
    EXPECT_EQ(all[0]["configuration"], "technique=separable");
    EXPECT_EQ(all[1]["configuration"], "technique=afis");
    ASSERT_FALSE(all[1]["selected_from_ms"].is_null()) << table["device"];
    EXPECT_GT(all[1]["selected_from_ms"], all[1]["ms"]);
  }
  EXPECT_EQ(judged, 3);
}

TEST_F(Choice, InvalidErrorTable_IsRejectedWithItsPlace) {
  const std::string file = write("errors.json", "{ \"dermis_errors\": 2,\n \"scene\": \"s\" }");
  EXPECT_THAT(run({"explain", graph, "--errors", file}),
              FailsWith(1, "2:2", "did you mean 'scenes'?", file + ": the choice cannot use"));
}

// Without the technique's row the choice cannot judge it, which explain reports like render.
TEST_F(Choice, ExplainReportsMissingRowsAndCosts) {
  const std::string table = write("errors.json", R"({ "dermis_errors": 2, "scenes": "invented",
    "unscattered": [[1, 0.05]], "techniques": [] })");
  const std::string costs = write("calibration.json", R"({ "dermis_calibration": 2,
    "device": "invented", "costs": [] })");
  const Outcome outcome = run({"explain", graph, "--errors", table, "--calibration", costs});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.err, HasAll("D0403", "subsurface.guided", "D0404", "subsurface.classify"));
  EXPECT_EQ(run({"explain", graph}).err, "");
}

TEST_F(Choice, BudgetOptionsAreChecked) {
  const auto rendered = [&](const char* option, const char* value) {
    return run({"render", scene, "--graph", graph, "--size", "64x36", "--frames", "1", "--subset",
                "0", "--budget", "5", option, value, "--out", path("out")});
  };
  EXPECT_THAT(rendered("--budget-percentile", "0.9"), Succeeds());
  EXPECT_THAT(rendered("--trials", "never"), Succeeds());
  EXPECT_EQ(rendered("--budget-percentile", "1").exit_code, 2);
  EXPECT_THAT(rendered("--trials", "often"), FailsWith(2, "never"));
}

TEST_F(Choice, AfisWithoutVelocityHasNoHistory) {
  const Outcome outcome =
      run({"explain", graph, "--set", "technique=afis", "--unbound", "velocity"});
  EXPECT_THAT(outcome,
              Succeeds("'off' instead of 'velocity'", "'velocity' is not bound", "0 B history"));
  EXPECT_THAT(outcome.out, HasSubstr("afis_fixed"));
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
  const Outcome outcome =
      run({"explain", "configs/graphs/papers/hybrid_afis_separable.json", "--frame", "--size",
           "64x36", "--set", "taps=11", "--set", "history=off", "--set", "samples=16", "--json"});
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

TEST_F(Choice, FreeConfigurationsAreListed) {
  const std::string free = write("free.json", R"({ "dermis_calibration": 2, "device": "free",
    "costs": [{ "work": "subsurface.classify", "base_us": 0, "group_us": 0, "spread": 0 }] })");
  EXPECT_THAT(run({"explain", graph, "--choices", "--calibration", free}), Succeeds("any budget"));
}

TEST_F(Choice, WarningsAreShownBesideJson) {
  const std::string empty =
      write("empty.json", R"({ "dermis_calibration": 2, "device": "none", "costs": [] })");
  for (const char* choices : {"--choices", "--two-queues"}) {
    const Outcome outcome = run({"explain", graph, choices, "--calibration", empty, "--json"});
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_THAT(outcome.err, HasSubstr("D0404"));
    EXPECT_TRUE(json::accept(outcome.out));
  }
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
  ASSERT_THAT(run({"bench", "budget", "--size", "48x27", "--frames", "4", "--scenes",
                   "flashing,zigzag_j1", "--repetitions", "1", "--cache", "", "--json", file}),
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
