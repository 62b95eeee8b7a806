// Tests the built-in calibrations of each class of devices.

#include "framegraph/model/read_graph.hpp"
#include "passes/choice/calibration.hpp"
#include "passes/choice/configurations.hpp"
#include "passes/choice/defaults.hpp"
#include "passes/common/pass_types.hpp"
#include "tests/support/shipped_graphs.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>

namespace {

using namespace dermis;
using namespace dermis::choice;

struct Calibrations : ::testing::TestWithParam<DeviceClass> {
  Diagnostics diagnostics;

  Calibration built_in() {
    const auto document = parse_document(
        "calibration", std::string(default_calibration_text(GetParam())), diagnostics);
    auto read = document ? read_calibration(*document, diagnostics) : std::nullopt;
    EXPECT_TRUE(read) << format_as_json(diagnostics);
    return read ? std::move(*read) : Calibration{};
  }

  // Returns the work of all configurations of a shipped graph that launches kernels.
  std::set<std::string> works_of_graph(const std::string& name) {
    const PassTypeRegistry pass_types = subsurface::make_pass_types();
    const DeviceProfile device = generic_profile();
    std::ifstream file(DERMIS_SOURCE_DIR "/" + shipped::graph_file(name));
    std::stringstream text;
    text << file.rdbuf();
    const auto document = parse_document(name, text.str(), diagnostics);
    const auto graph = document ? read_graph(*document, pass_types, diagnostics) : std::nullopt;
    EXPECT_TRUE(graph) << format_as_json(diagnostics);
    std::set<std::string> names;
    if (!graph) return names;
    CompileInput input;
    input.graph = &*graph;
    input.pass_types = &pass_types;
    input.device = &device;
    input.view_width = 640;
    input.view_height = 360;
    const auto combinations = enumerate_combinations(input, diagnostics);
    EXPECT_TRUE(combinations);
    for (const auto& settings : combinations->settings) {
      input.settings = settings;
      const auto compiled = compile(input, diagnostics);
      EXPECT_TRUE(compiled) << format_as_json(diagnostics);
      if (!compiled) continue;
      for (const Work& work : works_of(pass_types, compiled->plan, settings))
        if (work.load.launches) names.insert(work.name);
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

TEST_P(Calibrations, OfGpusAreLabelledAsModelled) {
  const bool modelled = built_in().device.ends_with(", modelled");
  EXPECT_EQ(modelled, GetParam() != DeviceClass::cpu);
}

INSTANTIATE_TEST_SUITE_P(Classes, Calibrations,
                         ::testing::Values(DeviceClass::cpu, DeviceClass::small_gpu,
                                           DeviceClass::large_gpu));

} // namespace
