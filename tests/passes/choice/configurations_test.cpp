#include "framegraph/model/read_graph.hpp"
#include "passes/choice/configurations.hpp"
#include "passes/choice/missing_rows.hpp"
#include "passes/common/pass_types.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using namespace dermis;
using namespace dermis::choice;

constexpr const char* errors_text = R"({ "dermis_errors": 2, "scenes": "invented",
"unscattered": [[1, 0.02], [4, 0.04]], "unscattered_through": 1.5,
"relief": [[1, 0.004], [4, 0.016]], "unscattered_relief_power": -0.1,
"techniques": [
 { "name": "burley 16", "pass_types": [{ "type": "subsurface.burley", "set": { "samples": 16 } }], "rmse": [[1, 0.004], [16, 0.016]], "relief_power": 0.5 },
 { "name": "separable", "pass_types": [{ "type": "subsurface.separable" }], "rmse": [[1, 0.003]] },
 { "name": "separable 11", "pass_types": [{ "type": "subsurface.separable", "set": { "taps": "11" } }], "rmse": [[1, 0.005]],
   "through": 0.5, "by_rays": true }] })";

struct Compiled {
  std::vector<Configuration> configurations;
  std::vector<CompiledPlan> plans;
};

struct Configurations : ::testing::Test {
  PassTypeRegistry pass_types = subsurface::make_pass_types();
  DeviceProfile device = generic_profile();
  Diagnostics diagnostics;
  ErrorModel errors;
  CostEstimator costs;
  std::optional<Graph> graph;

  void SetUp() override {
    const auto document = parse_document("errors.json", errors_text, diagnostics);
    ASSERT_TRUE(document);
    auto model = read_error_model(*document, diagnostics);
    ASSERT_TRUE(model) << format_as_json(diagnostics);
    errors = std::move(*model);
  }

  std::optional<Compiled> configurations_of(const std::string& settings,
                                            const std::string& extra_set = "") {
    const std::string common =
        R"("read": { "light": "light", "view_depth": "view_depth",
      "tiles": "tiles", "arguments": "arguments")";
    const std::string text = R"({ "dermis": 2, "name": "g", "settings": {)" + settings + R"(},
    "imports": { "lighting": { "format": "rgba16f", "size": "view" }, "depth": { "format": "depth", "size": "view" },
                 "material": { "format": "r8_uint", "size": "view" } },
    "resources": { "classes": { "buffer": { "stride": 4, "count": "view/8" } },
      "list_state": { "buffer": { "stride": 4, "count": "view/64", "extra": 8 } },
      "tiles": { "buffer": { "stride": 4, "count": "view/8", "extra": 1 } },
      "arguments": { "buffer": { "stride": 4, "count": [4, 1] } },
      "light": { "format": "rgba16f", "size": "view" }, "view_depth": { "format": "r32f", "size": "view" },
      "blurred": { "format": "rgba16f", "size": "view" }, "scattered": { "format": "rgba16f", "size": "view" } },
    "passes": [
      { "pass": "classify", "type": "subsurface.classify", "read": { "material": "material", "depth": "depth" }, "write": { "classes": "classes", "list_state": "list_state" } },
      { "pass": "list", "type": "subsurface.tile_list", "read": { "classes": "classes" }, "write": { "list_state": "list_state", "tiles": "tiles", "arguments": "arguments" } },
      { "pass": "setup", "type": "subsurface.separable_setup",
        "read": { "lighting": "lighting", "material": "material", "depth": "depth", "classes": "classes" },
        "write": { "light": "light", "view_depth": "view_depth" } },
      { "pass": "horizontal", "type": "subsurface.separable", "when": "technique == 'separable'", )" +
                             common + R"(},
        "write": { "scattered": "blurred" }, "set": { "axis": "horizontal")" +
                             extra_set + R"( } },
      { "pass": "vertical", "type": "subsurface.separable", "when": "technique == 'separable'", )" +
                             common + R"(, "blurred": "blurred" },
        "write": { "scattered": "scattered" }, "set": { "axis": "vertical")" +
                             extra_set + R"( }, "otherwise": { "scattered": "light" } },
      { "pass": "combine", "type": "subsurface.combine",
        "read": { "scattered": "scattered", "material": "material", "tiles": "tiles", "arguments": "arguments" },
        "write": { "lighting": "lighting" } } ],
    "exports": ["lighting"] })";
    const auto document = parse_document("graph.json", text, diagnostics);
    if (!document) return std::nullopt;
    graph = read_graph(*document, pass_types, diagnostics);
    if (!graph) return std::nullopt;
    CompileInput input;
    input.graph = &*graph;
    input.pass_types = &pass_types;
    input.device = &device;
    input.view_width = 640;
    input.view_height = 360;
    const auto combinations = enumerate_combinations(input, diagnostics);
    if (!combinations) return std::nullopt;
    Compiled out;
    std::vector<const Plan*> made;
    out.plans.reserve(combinations->first.size());
    for (const uint32_t first : combinations->first) {
      CompileInput one = input;
      one.settings = combinations->settings[first];
      auto compiled = compile(one, diagnostics);
      if (!compiled) return std::nullopt;
      made.push_back(&out.plans.emplace_back(std::move(*compiled)).plan);
    }
    out.configurations = make_configurations(input, *combinations, made, errors, costs);
    return out;
  }
};

TEST_F(Configurations, GraphWithoutChoices_HasOneConfiguration) {
  const auto all =
      configurations_of(R"("technique": { "enum": ["separable", "off"], "default": "separable" })");
  ASSERT_TRUE(all) << format_as_json(diagnostics);
  ASSERT_EQ(all->configurations.size(), 1u);
  EXPECT_EQ(all->plans.size(), 1u);
}

TEST_F(Configurations, EqualWork_IsOneConfiguration) {
  const auto all = configurations_of(
      R"("technique": { "choice": ["separable", "off"], "by": "budget", "default": "separable" },
    "taps": { "choice": ["11", "17", "25"], "by": "budget", "default": "25" })",
      R"(, "taps": "$taps")");
  ASSERT_TRUE(all) << format_as_json(diagnostics);
  // Three configurations have taps; without the technique, taps have no effect.
  ASSERT_EQ(all->configurations.size(), 4u);
  EXPECT_EQ(all->plans.size(), 2u);
  EXPECT_EQ(all->configurations[0].name, "technique=separable, taps=25");
  EXPECT_EQ(all->configurations[0].technique, 1); // This row holds for any number of taps.
  EXPECT_EQ(all->configurations[1].technique, 2); // The row for 11 taps is more specific.
  EXPECT_EQ(all->configurations.back().technique, -1);
  EXPECT_EQ(all->configurations.back().name, "technique=off"); // No pass that runs has taps.
}

TEST_F(Configurations, ErrorsAreLinearOnLogarithmicAxes) {
  EXPECT_NEAR(expected_rmse(errors, 0, {4}), 0.008, 1e-12);
  EXPECT_NEAR(expected_rmse(errors, 0, {0.1}), 0.004, 1e-12);
  EXPECT_NEAR(expected_rmse(errors, 0, {100}), 0.016, 1e-12);
  EXPECT_NEAR(expected_rmse(errors, -1, {2}), std::sqrt(0.02 * 0.04), 1e-12);
}

TEST_F(Configurations, ErrorsFollowRelief) {
  // Usual relief at d = 2 is 0.008; the table adds 0.001 to that of a frame.
  const double usual = expected_rmse(errors, 0, {2});
  EXPECT_NEAR(expected_rmse(errors, 0, {2, 0.007}), usual, 1e-12);
  EXPECT_NEAR(expected_rmse(errors, 0, {2, 0.031}), 2 * usual, 1e-12);
  EXPECT_NEAR(expected_rmse(errors, 0, {2, 0}), usual * std::sqrt(0.125), 1e-12);
  EXPECT_NEAR(expected_rmse(errors, 1, {2, 0.9}), expected_rmse(errors, 1, {2}), 1e-12)
      << "a row without power";
  EXPECT_NEAR(expected_rmse(errors, -1, {2, 0.031}),
              expected_rmse(errors, -1, {2}) * std::pow(4, -0.1), 1e-12);
}

TEST_F(Configurations, WrongRelief_IsRejected) {
  for (const char* relief :
       {"[[1, 0.1, 2]]", "[[1, 0]]", "[[1, 2]]", "[[2, 0.1], [1, 0.1]]", "[]", "[0.1]"}) {
    Diagnostics other;
    const auto document =
        parse_document("errors.json",
                       std::string(R"({ "dermis_errors": 2, "scenes": "s", "techniques": [], )") +
                           R"("unscattered": [[1, 0.1]], "relief": )" + relief + "}",
                       other);
    ASSERT_TRUE(document);
    EXPECT_FALSE(read_error_model(*document, other)) << relief;
    ASSERT_EQ(other.list.size(), 1u) << relief << format_as_json(other);
    EXPECT_GT(other.list[0].where.line, 0u) << relief;
  }
}

TEST_F(Configurations, MissedTransmission_MatchesTheTable) {
  EXPECT_NEAR(missed_rmse(errors, 2, 0.3), 0.15, 1e-12);
  EXPECT_NEAR(missed_rmse(errors, -1, 0.3), 0.45, 1e-12);
  EXPECT_EQ(missed_rmse(errors, 0, 0.3), 0); // The table has no number for this case.
  EXPECT_TRUE(errors.techniques[2].by_rays);
  EXPECT_FALSE(errors.techniques[0].by_rays);
}

TEST_F(Configurations, PartialSamples_InterpolateTheSquaredError) {
  Configuration configuration;
  configuration.technique = 0;
  configuration.without_samples = -1;
  configuration.takes_samples = true;
  const double all = expected_rmse(errors, 0, {4}), none = expected_rmse(errors, -1, {4});
  EXPECT_NEAR(expected_rmse(errors, configuration, {4}, 0, 100), none, 1e-12);
  EXPECT_NEAR(expected_rmse(errors, configuration, {4}, 100, 100), all, 1e-12);
  EXPECT_NEAR(expected_rmse(errors, configuration, {4}, 25, 100),
              std::sqrt(0.75 * none * none + 0.25 * all * all), 1e-12);
  // More samples than requested have no effect.
  EXPECT_NEAR(expected_rmse(errors, configuration, {4}, 200, 100), all, 1e-12);
  EXPECT_NEAR(expected_rmse(errors, configuration, {4}, 5, 0), none,
              1e-12); // No tile requests samples.
  configuration.takes_samples = false;
  EXPECT_NEAR(expected_rmse(errors, configuration, {4}, 0, 100), all, 1e-12);
}

TEST_F(Configurations, CostsGrowWithTheListedTiles) {
  const auto all =
      configurations_of(R"("technique": { "enum": ["separable", "off"], "default": "separable" })");
  ASSERT_TRUE(all);
  const auto ms = [&](uint64_t tiles) {
    return calibrated_ms(all->configurations[0], costs,
                         {.width = 640, .height = 360, .listed_tiles = tiles});
  };
  const double group_ms = costs.calibrated_cost(all->configurations[0].passes.back().cost).group_ms;
  EXPECT_GT(group_ms, 0);
  // Two passes and combine run over listed tiles.
  EXPECT_NEAR(ms(3600) - ms(100), 3 * 3500 * group_ms, 1e-9);
}

// Passes over the tiles of coarse levels launch more groups where pixels are not square.
TEST_F(Configurations, LevelGroups_FollowThePixelGrid) {
  const auto groups = [&](double aspect, uint32_t level) {
    Plan plan;
    plan.pixel_grid = pixel_grid(aspect);
    plan.settings.resize(2);
    plan.settings[0].value.integer = level;
    plan.passes.emplace_back();
    plan.passes[0].type = pass_types.find("subsurface.sap_down");
    const std::vector<Work> works = works_of(pass_types, plan, {});
    return groups_of(works.at(0).load, {.width = 640, .height = 360, .listed_tiles = 100});
  };
  EXPECT_EQ(groups(1, 1), 100u);
  EXPECT_EQ(groups(1.2, 3), 100u);
  EXPECT_EQ(groups(2, 1), 200u);
  EXPECT_EQ(groups(0.5, 4), 200u);
  EXPECT_EQ(groups(4, 1), 200u);
  EXPECT_EQ(groups(0.25, 2), 400u);
  EXPECT_EQ(groups(4, 5), 400u);
}

// The choice names passes that neither table knows; `off` needs no row.
TEST_F(Configurations, MissingRows_AreReportedAtTheChoice) {
  const auto report = [&](const Compiled& all, const CostEstimator& known) {
    std::vector<const Plan*> plans;
    for (const CompiledPlan& one : all.plans)
      plans.push_back(&one.plan);
    Diagnostics reported;
    report_missing_rows(*graph, pass_types, plans, errors, known, all.configurations, reported);
    return reported;
  };
  std::vector<Cost> all_types;
  for (const char* type : {"classify", "tile_list", "separable_setup", "separable", "combine"})
    all_types.push_back({std::string("subsurface.") + type + " other=setting", 10, 1, 0.1});
  costs = CostEstimator(all_types);
  constexpr const char* choice =
      R"(
    "technique": { "choice": ["separable", "off"], "by": "budget", "default": "separable" })";
  const auto all = configurations_of(choice);
  ASSERT_TRUE(all) << format_as_json(diagnostics);
  EXPECT_TRUE(report(*all, costs).list.empty());

  errors.techniques.clear();
  const auto without_row = configurations_of(choice);
  const Diagnostics row = report(*without_row, costs);
  ASSERT_EQ(row.list.size(), 1u) << format_as_json(row);
  EXPECT_EQ(row.list[0].id, DiagnosticId::error_row_missing);
  EXPECT_EQ(row.list[0].where.line, 2u);
  EXPECT_NE(row.list[0].text.find("'subsurface.separable' of 'technique=separable'"),
            std::string::npos)
      << row.list[0].text;

  SetUp(); // restores the error table
  all_types.erase(all_types.begin() + 3);
  costs = CostEstimator(all_types);
  const auto without_cost = configurations_of(choice);
  const Diagnostics cost = report(*without_cost, costs);
  ASSERT_EQ(cost.list.size(), 1u) << format_as_json(cost);
  EXPECT_EQ(cost.list[0].id, DiagnosticId::cost_missing);
  EXPECT_NE(cost.list[0].text.find("'subsurface.separable', which 'technique=separable' runs"),
            std::string::npos)
      << cost.list[0].text;
}

TEST_F(Configurations, TooManyConfigurations_AreRejectedAtTheChoice) {
  EXPECT_FALSE(configurations_of(
      "\"technique\": { \"choice\": [\"separable\", \"b\", \"c\", \"d\", \"e\", \"f\", "
      "\"g\", \"h\"], \"by\": \"budget\", "
      "\"default\": \"b\" },\n"
      "\"two\": { \"choice\": [\"a\", \"b\", \"c\", \"d\", \"e\", \"f\", \"g\", \"h\", "
      "\"i\"], \"by\": \"budget\", \"default\": \"a\" }"));
  ASSERT_EQ(diagnostics.count(Severity::error), 1u) << format_as_json(diagnostics);
  EXPECT_EQ(diagnostics.list.back().id, DiagnosticId::too_many_configurations);
  EXPECT_EQ(diagnostics.list.back().where.line, 2u);
}

// Fixed work takes 10 ms, a dispatch of samples 0.1 ms, and a unit of samples 1 us.
TEST(ForecastTime, SeparatesSamplesFromOtherWork) {
  CostEstimator costs({{"fixed work", 10000, 0, 0.1}, {"samples", 100, 1, 0}});
  Configuration configuration;
  PassLoad work, samples;
  work.cost = costs.add("fixed work");
  samples.cost = costs.add("samples");
  samples.groups = PassLoad::Groups::sample_units;
  configuration.passes = {work, samples};
  FrameLoad load;
  load.sample_units = 500; // has no effect
  const TimeForecast calibrated = forecast_time(configuration, costs, {}, load);
  EXPECT_NEAR(calibrated.expected_ms, 10.1, 1e-9);
  EXPECT_EQ(calibrated.pessimistic_ms, calibrated.expected_ms);
  EXPECT_EQ(calibrated.optimistic_ms, calibrated.expected_ms);
  EXPECT_NEAR(calibrated.unit_ms, 1e-3, 1e-12);
  EXPECT_FALSE(calibrated.measured);

  const PassTime frame[] = {{work.cost, 1, 20}, {samples.cost, 100, 0.6}};
  for (int i = 1; i <= 10; ++i)
    costs.observe(frame, i / 60.0);
  const TimeForecast measured = forecast_time(configuration, costs, costs.predict(0.2), load);
  EXPECT_NEAR(measured.expected_ms, 20.3, 0.01);
  EXPECT_NEAR(measured.unit_ms, 3e-3, 1e-5);
  EXPECT_TRUE(measured.measured);
}

// Returns the name of the work of a pass with two settings, of which the first is per frame.
std::string name_with(const SettingValue& per_frame, const SettingValue& other) {
  PassTypeSetting settings[2];
  settings[0].name = "weight";
  settings[0].type = per_frame.type;
  settings[0].per_frame = true;
  settings[1].name = "radius";
  settings[1].type = other.type;
  PassType type;
  type.name = "pass";
  type.settings = settings;
  const SettingValue values[] = {per_frame, other};
  return work_name(type, values);
}
SettingValue real_value(double value) {
  return {SettingType::real, 0, value};
}
SettingValue integer_value(int64_t value) {
  return {SettingType::integer, value, 0};
}

// Hosts animate settings; each name of a work takes memory.
TEST(WorkNames, RealsPerFrame_HaveOneDigit) {
  EXPECT_EQ(name_with(real_value(0.127), real_value(1.25)), "pass weight=0.1 radius=1.2");
  EXPECT_EQ(name_with(real_value(0.13), real_value(1.5)), "pass weight=0.1 radius=1.5");
  // Others have two: a slider may change them, too.
  EXPECT_EQ(name_with(real_value(1), real_value(-2.1234)), "pass weight=1 radius=-2.1");
}

TEST(WorkNames, IntegersPerFrame_HaveTwoDigits) {
  EXPECT_EQ(name_with(integer_value(32), integer_value(1234)), "pass weight=32 radius=1234");
  EXPECT_EQ(name_with(integer_value(128), integer_value(1)), "pass weight=120 radius=1");
  EXPECT_EQ(name_with(integer_value(-1999999999), integer_value(1)),
            "pass weight=-1900000000 radius=1");
}

TEST(SameWork, ValuesThatCostTheSame_AreTheSame) {
  CostEstimator costs;
  Configuration a;
  a.passes.resize(1);
  a.passes.front().cost = costs.add("pass weight=0.1");
  Configuration b = a;
  EXPECT_TRUE(is_same_work(a, b));
  b.passes.front().cost = costs.add("pass weight=0.2");
  EXPECT_FALSE(is_same_work(a, b));
  b = a;
  b.technique = 3;
  EXPECT_FALSE(is_same_work(a, b));
}

// Passes without groups have no times: combine_copies of frames in which all tiles scatter.
TEST(ForecastTime, EmptyPass_DoesNotLeaveTheTimeUnknown) {
  CostEstimator costs({{"work", 100, 1, 0.1}, {"copies", 50, 1, 0.1}});
  PassLoad work, copies;
  work.cost = costs.add("work");
  copies.cost = costs.add("copies");
  copies.groups = PassLoad::Groups::copied_tiles;
  Configuration configuration;
  configuration.passes = {work, copies};
  const PassTime frame[] = {{work.cost, 1, 0.1}, {copies.cost, 0, 0.05}};
  for (int i = 1; i <= 10; ++i)
    costs.observe(frame, i / 60.0);
  FrameLoad load;
  EXPECT_TRUE(forecast_time(configuration, costs, costs.predict(0.2), load).measured);
  load.copied_tiles = 1;
  EXPECT_FALSE(forecast_time(configuration, costs, costs.predict(0.2), load).measured);
}

TEST_F(Configurations, WrittenErrorTable_ReadsBackEqual) {
  errors.techniques[0].curve[0].spread = 1.5;
  Diagnostics other;
  const std::string text = write_error_model(errors, "made by hand");
  EXPECT_NE(text.find("made by hand"), std::string::npos);
  const auto document = parse_document("errors.json", text, other);
  const auto read = document ? read_error_model(*document, other) : std::nullopt;
  ASSERT_TRUE(read) << format_as_json(other);
  EXPECT_EQ(write_error_model(*read, "made by hand"), text);
  ASSERT_EQ(read->techniques.size(), errors.techniques.size());
  EXPECT_EQ(read->techniques[0].curve[0].spread, 1.5);
  EXPECT_EQ(read->techniques[0].curve[1].spread, 1);
  EXPECT_EQ(read->techniques[0].pass_types[0].settings[0].value, "16");
  EXPECT_EQ(read->techniques[2].through, 0.5);
  EXPECT_TRUE(read->techniques[2].by_rays);
  EXPECT_EQ(read->unscattered_through, errors.unscattered_through);
  EXPECT_EQ(read->unscattered_relief_power, -0.1);
  EXPECT_EQ(read->techniques[0].relief_power, 0.5);
  ASSERT_EQ(read->relief.size(), 2u);
  EXPECT_EQ(read->relief[1].relief, 0.016);
}

TEST_F(Configurations, WrongSpread_IsRejected) {
  for (const char* point : {"[1, 0.1, 0.5]", "[1, 0.1, 1.5, 2]"}) {
    Diagnostics other;
    const auto document = parse_document(
        "errors.json",
        std::string(R"({ "dermis_errors": 2, "scenes": "s", "techniques": [], "unscattered": [)") +
            point + "] }",
        other);
    ASSERT_TRUE(document);
    EXPECT_FALSE(read_error_model(*document, other));
    ASSERT_EQ(other.count(Severity::error), 1u) << format_as_json(other);
    EXPECT_EQ(other.list[0].id, DiagnosticId::out_of_range);
  }
}

TEST_F(Configurations, CurvesThatDoNotIncreaseAreRejected) {
  Diagnostics other;
  const auto document = parse_document("errors.json",
                                       "{ \"dermis_errors\": 2, \"scenes\": \"s\", \"techniques\": "
                                       "[],\n\"unscattered\": [[4, 0.1], [2, 0.2]] }",
                                       other);
  ASSERT_TRUE(document);
  EXPECT_FALSE(read_error_model(*document, other));
  ASSERT_EQ(other.count(Severity::error), 1u) << format_as_json(other);
  EXPECT_EQ(other.list[0].id, DiagnosticId::error_curve);
  EXPECT_EQ(other.list[0].where.pointer, "/unscattered/1");
}

} // namespace
