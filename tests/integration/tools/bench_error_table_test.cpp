// Tests `dermis bench error-table`: the table that it writes, and how it fits and judges curves.
#include "integration/tools/command/bench/error_table/error_table_file.hpp"
#include "integration/tools/command/bench/error_table/judge_choice.hpp"
#include "integration/tools/command/bench/error_table/table_fit.hpp"
#include "integration/tools/command/graph_input.hpp"
#include "passes/choice/configurations.hpp"
#include "tests/integration/tools/command_fixture.hpp"

#include <cmath>

namespace dermis::tools {
namespace {

using namespace dermis::test;

choice::ErrorModel read_table(const std::string& name, const std::string& text) {
  Diagnostics diagnostics;
  const auto document = parse_document(name, text, diagnostics);
  auto table = document ? choice::read_error_model(*document, diagnostics) : std::nullopt;
  EXPECT_TRUE(table) << format_as_json(diagnostics);
  return table ? std::move(*table) : choice::ErrorModel{};
}

choice::ErrorModel shipped_table() {
  return read_table("errors.json", read_text(DERMIS_SOURCE_DIR "/configs/choice/errors.json"));
}

MeasuredError measured(const std::string& scene_class, double d_px, double rmse,
                       const std::string& half = "tuning") {
  return {"sap smooth", "scene", scene_class, half, d_px, rmse};
}

TEST(ErrorTableFit, ClassesHaveEqualWeight) {
  const std::vector<MeasuredError> errors = {measured("fold", 2, 1e-3), measured("fold", 2, 4e-3),
                                             measured("plane", 2.02, 8e-3), measured("plane", 4, 1),
                                             measured("plane", 2, 1, "judging")};
  const std::vector<double> d_px = {1, 2};
  const auto curve = fit_curve(errors, "sap smooth", d_px);
  ASSERT_EQ(curve.size(), 1u) << "no errors at d = 1";
  EXPECT_EQ(curve[0].d_px, 2);
  EXPECT_NEAR(curve[0].rmse, 4e-3, 1e-9); // Mean of 2e-3 and 8e-3.
  // Squares of ln 4, 0 and ln 2.
  const double square = std::log(2.0) * std::log(2.0);
  EXPECT_NEAR(std::log(curve[0].spread), std::sqrt((2 * square + square) / 2), 2e-3);
}

TEST(ErrorTableFit, FindsThePowerOfRelief) {
  std::vector<MeasuredError> errors;
  for (const double d_px : {1.0, 4.0})
    for (const double relief : {0.0, 0.001, 0.01, 0.1}) {
      errors.push_back(measured("fold", d_px, 0.05 * d_px * std::pow(relief + 0.001, 0.25)));
      errors.back().relief = relief;
    }
  errors.push_back(measured("plane", 1, 1, "judging"));
  choice::ErrorModel table;
  table.unscattered = {{1, 1}};
  table.techniques.push_back({"sap smooth", {}, {{1, 1}}});
  const std::vector<double> d_px = {1, 4};
  fit_table(table, errors, d_px);
  EXPECT_NEAR(table.techniques[0].relief_power, 0.25, 1e-3);
  EXPECT_EQ(table.unscattered_relief_power, 0) << "not measured";
  ASSERT_EQ(table.relief.size(), 2u);
  // The curve is rounded to three digits.
  EXPECT_NEAR(expected_rmse(table, 0, {4, 0.01}) / errors[6].rmse, 1, 0.01);
  EXPECT_LT(judge_table(table, errors, "sap smooth", "tuning").rms, 0.01);
}

TEST(ErrorTableFit, JudgesOneHalfOnly) {
  choice::ErrorModel table;
  table.unscattered = {{1, 1}};
  table.techniques.push_back({"sap smooth", {}, {{1, 2e-3}}});
  const std::vector<MeasuredError> errors = {measured("fold", 2, 1e-3, "judging"),
                                             measured("fold", 3, 4e-3, "judging"),
                                             measured("fold", 2, 1)};
  const PredictionError found = judge_table(table, errors, "sap smooth", "judging");
  EXPECT_EQ(found.scenes, 2u);
  EXPECT_NEAR(found.mean, 0, 1e-12);
  EXPECT_NEAR(found.rms, std::log(2.0), 1e-12);
  EXPECT_EQ(judge_table(table, errors, "unknown", "judging").scenes, 0u);
}

// Returns the name of the row that a graph with these settings finds.
std::string row_found(const choice::ErrorModel& table, const TechniqueRequest& request) {
  Diagnostics diagnostics;
  auto loaded = load_graph(request.graph, GraphInputs{}, diagnostics);
  if (!loaded) return format_as_json(diagnostics);
  const CompileChoices choices = read_choices(loaded->graph, request.set);
  const Size size{256, 144};
  const auto plan = compile_generic(*loaded, size, choices, diagnostics);
  if (!plan) return format_as_json(diagnostics);
  choice::Configuration configuration;
  configuration.settings = choices.settings;
  choice::CostEstimator costs;
  const std::array<const Plan*, 1> plans = {&plan->plan};
  choice::describe_configurations(loaded->pass_types, plans, table, costs,
                                  std::span(&configuration, 1));
  return configuration.technique < 0
             ? "off"
             : table.techniques[static_cast<size_t>(configuration.technique)].name;
}

TEST(ErrorTableChoice, MeasuredErrorsLeadToTheBestTechnique) {
  choice::ErrorModel table;
  table.unscattered = {{1, 1}};
  table.techniques = {{"a", {}, {{1, 1e-3}}}, {"b", {}, {{1, 2e-3}}}};
  const std::vector<MeasuredError> errors = {
      {"off", "worse", "fold", "judging", 1, 1},    {"off", "as said", "fold", "judging", 1, 1},
      {"a", "worse", "fold", "judging", 1, 8e-3},   {"b", "worse", "fold", "judging", 1, 2e-3},
      {"a", "as said", "fold", "judging", 1, 1e-3}, {"b", "as said", "fold", "judging", 1, 2e-3},
      {"a", "not in b", "fold", "judging", 1, 1},   {"a", "other half", "fold", "tuning", 1, 1}};
  const std::vector<std::string> techniques = {"a", "b"};
  const ChoiceError by_table = judge_choice(table, errors, techniques, "judging");
  EXPECT_EQ(by_table.scenes, 2u);
  EXPECT_NEAR(by_table.mean, 2, 1e-9);
  EXPECT_NEAR(by_table.worst, 4, 1e-9);
  EXPECT_EQ(by_table.switches, 0);
  const ChoiceError measuring = judge_measuring_choice(table, errors, techniques, "judging");
  EXPECT_NEAR(measuring.mean, 1, 1e-9);
  EXPECT_EQ(measuring.switches, 0.5);
  EXPECT_EQ(judge_choice(table, errors, techniques, "tuning").scenes, 0u);
}

TEST(ErrorTableFile, EachTechniqueFindsItsRow) {
  Diagnostics diagnostics;
  const auto file =
      read_error_table(DERMIS_SOURCE_DIR "/tests/benchmark/error_table.json", diagnostics);
  ASSERT_TRUE(file) << format_as_json(diagnostics);
  const choice::ErrorModel table = shipped_table();
  for (const TabledTechnique& request : file->techniques) {
    const std::string name =
        request.setting.empty() ? request.technique : request.technique + " " + request.setting;
    EXPECT_EQ(row_found(table, request), name) << request.graph;
  }
  for (const choice::TechniqueError& row : table.techniques)
    if (!row.by_rays) {
      EXPECT_GE(row.curve.size(), 5u) << row.name;
    }
}

class BenchErrorTable : public CommandTest {};

TEST_F(BenchErrorTable, ReplacesMeasuredCurvesOnly) {
  const std::vector<std::string> arguments = {"bench",          "error-table",       "--quick",
                                              "--scenes",       "plane,fold",        "--techniques",
                                              "separable",      "--cache",           path("cache"),
                                              "--out",          path("errors.json"), "--json",
                                              path("rows.json")};
  ASSERT_THAT(run(arguments), Succeeds("separable 25", "mean ratio"));
  EXPECT_THAT(run({"validate", path("errors.json")}), Succeeds());
  const choice::ErrorModel before = shipped_table(),
                           after = read_table("errors.json", read("errors.json"));
  ASSERT_EQ(after.techniques.size(), before.techniques.size());
  for (size_t i = 0; i < after.techniques.size(); ++i) {
    const choice::TechniqueError &old = before.techniques[i], &now = after.techniques[i];
    EXPECT_EQ(now.name, old.name);
    EXPECT_EQ(now.through, old.through);
    EXPECT_EQ(now.by_rays, old.by_rays);
    EXPECT_EQ(now.pass_types.size(), old.pass_types.size());
    EXPECT_EQ(now.curve.size(), now.name == "separable 25" ? 1u : old.curve.size()) << now.name;
  }
  // The table of the same rows, fitted without measuring.
  ASSERT_THAT(run({"bench", "error-table", "--quick", "--rows", path("rows.json"), "--out",
                   path("again.json")}),
              Succeeds("separable 25", "device of the rows"));
  EXPECT_EQ(read("again.json"), read("errors.json"));
  EXPECT_THAT(run({"bench", "error-table", "--rows", path("errors.json")}), FailsWith(1, "report"));
  EXPECT_THAT(
      run({"bench", "error-table", "--rows", path("rows.json"), "--techniques", "separable"}),
      FailsWith(2, "leave out --scenes and --techniques"));
  EXPECT_THAT(read("rows.json"), HasAll(R"("technique": "separable 25")", R"("rmse": 0.0)"));
  EXPECT_THAT(run({"bench", "error-table", "--scenes", "plane,nowhere"}),
              FailsWith(2, "--scenes: unknown 'nowhere'; available: ", "plane"));
}

} // namespace
} // namespace dermis::tools
