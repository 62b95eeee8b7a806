// Tests the built-in calibrations of each class of devices.

#include "framegraph/model/read_graph.hpp"
#include "passes/choice/calibration.hpp"
#include "passes/choice/configurations.hpp"
#include "passes/choice/defaults.hpp"
#include "passes/choice/missing_rows.hpp"
#include "passes/common/pass_types.hpp"
#include "tests/support/shipped_graphs.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <set>

namespace {

using namespace dermis;
using namespace dermis::choice;

TEST(CalibrationFile, DuplicateOrUnnamedCosts_AreRejected) {
  const auto read = [](const std::string& costs, Diagnostics& diagnostics) {
    const auto document = parse_document(
        "c.json", R"({ "dermis_calibration": 2, "device": "d", "costs": [)" + costs + "] }",
        diagnostics);
    return document && read_calibration(*document, diagnostics);
  };
  const auto cost = [](const std::string& work) {
    return R"({ "work": ")" + work + R"(", "base_us": 1, "group_us": 1, "spread": 0 })";
  };
  Diagnostics good, twice, unnamed;
  EXPECT_TRUE(read(cost("a") + ", " + cost("b"), good)) << format_as_json(good);
  EXPECT_FALSE(read(cost("a") + ", " + cost("a"), twice));
  ASSERT_EQ(twice.list.size(), 1u);
  EXPECT_EQ(twice.list[0].id, DiagnosticId::duplicate_name);
  EXPECT_FALSE(read(cost(""), unnamed));
}

struct Calibrations : ::testing::TestWithParam<DeviceClass> {
  Diagnostics diagnostics;

  Calibration built_in() {
    const auto document = parse_document(
        "calibration", std::string(default_calibration_text(GetParam())), diagnostics);
    auto read = document ? read_calibration(*document, diagnostics) : std::nullopt;
    EXPECT_TRUE(read) << format_as_json(diagnostics);
    return read ? std::move(*read) : Calibration{};
  }

  PassTypeRegistry pass_types = subsurface::make_pass_types();
  DeviceProfile device = generic_profile();
  std::optional<Graph> graph;

  // Returns the input that compiles a shipped graph; nullopt on failure.
  std::optional<CompileInput> input_of(const std::string& name) {
    const auto document =
        read_document(DERMIS_SOURCE_DIR "/" + shipped::graph_file(name), diagnostics);
    graph = document ? read_graph(*document, pass_types, diagnostics) : std::nullopt;
    EXPECT_TRUE(graph) << format_as_json(diagnostics);
    if (!graph) return std::nullopt;
    CompileInput input;
    input.graph = &*graph;
    input.pass_types = &pass_types;
    input.device = &device;
    input.view_width = 640;
    input.view_height = 360;
    return input;
  }

  void expect_covered(const std::string& name, const ErrorModel& errors) {
    const auto input = input_of(name);
    const auto combinations =
        input ? enumerate_combinations(*input, diagnostics) : std::optional<Combinations>();
    ASSERT_TRUE(combinations) << format_as_json(diagnostics);
    std::vector<CompiledPlan> compiled;
    for (const uint32_t first : combinations->first) {
      CompileInput one = *input;
      one.settings = combinations->settings[first];
      auto plan = compile(one, diagnostics);
      ASSERT_TRUE(plan) << format_as_json(diagnostics);
      compiled.push_back(std::move(*plan));
    }
    std::vector<const Plan*> plans;
    for (const CompiledPlan& one : compiled)
      plans.push_back(&one.plan);
    CostEstimator costs(built_in().costs);
    const auto all = make_configurations(*input, *combinations, plans, errors, costs);
    Diagnostics missing;
    report_all_missing_rows(*graph, pass_types, plans, errors, costs, all, missing);
    EXPECT_TRUE(missing.list.empty()) << format_as_json(missing);
  }

  // Returns the work of all configurations of a shipped graph.
  std::set<std::string> works_of_graph(const std::string& name) {
    std::set<std::string> names;
    auto given = input_of(name);
    if (!given) return names;
    CompileInput& input = *given;
    const auto combinations = enumerate_combinations(input, diagnostics);
    EXPECT_TRUE(combinations);
    for (const auto& settings : combinations->settings) {
      input.settings = settings;
      const auto compiled = compile(input, diagnostics);
      EXPECT_TRUE(compiled) << format_as_json(diagnostics);
      if (!compiled) continue;
      for (const Work& work : works_of(pass_types, compiled->plan, settings))
        names.insert(work.name);
    }
    return names;
  }
};

TEST_P(Calibrations, NameTheWorkOfTheBudgetsGraphs) {
  std::set<std::string> known;
  for (const Cost& cost : built_in().costs)
    known.insert(cost.work);
  for (const char* graph : {"skin", "hybrid"})
    for (const std::string& work : works_of_graph(graph))
      EXPECT_TRUE(known.contains(work)) << graph << ": " << work;
}

// Each configuration of each shipped graph has a row in the error table and costs of its passes.
TEST_P(Calibrations, ErrorsAndCosts_CoverEachShippedGraph) {
  const auto document = parse_document("errors", std::string(default_errors_text()), diagnostics);
  const auto errors = document ? read_error_model(*document, diagnostics) : std::nullopt;
  ASSERT_TRUE(errors) << format_as_json(diagnostics);
  device.features = ~Features{0}; // of graphs that choose rays
  for (const std::string& file : shipped::graph_files()) {
    SCOPED_TRACE(file);
    expect_covered(std::filesystem::path(file).stem().string(), *errors);
  }
}

TEST_P(Calibrations, GpuCalibrationsAreLabelledAsModelled) {
  const bool modelled = built_in().device.ends_with(", modelled");
  EXPECT_EQ(modelled, GetParam() != DeviceClass::cpu);
}

INSTANTIATE_TEST_SUITE_P(Classes, Calibrations,
                         ::testing::Values(DeviceClass::cpu, DeviceClass::small_gpu,
                                           DeviceClass::large_gpu));

} // namespace
