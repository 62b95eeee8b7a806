// The schema of plans accepts the compiler's output, and reports the place of any difference.

#include "framegraph/compile/compile.hpp"
#include "framegraph/explain/plan_json.hpp"
#include "framegraph/model/read_graph.hpp"
#include "passes/common/pass_types.hpp"
#include "tests/schema/validator.hpp"
#include "tests/support/shipped_graphs.hpp"

#include <filesystem>
#include <gtest/gtest.h>

namespace dermis::testing {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct PlanSchema : ::testing::Test {
  SchemaFile schema = schema_in("configs/schema/plan.schema.json");
  PassTypeRegistry pass_types = subsurface::make_pass_types();
  DeviceProfile device = generic_profile();

  // Returns the plan as JSON, with every optional slot bound or with none.
  json plan_of(const std::string& path, bool bound) {
    Diagnostics diagnostics;
    const auto document = read_document(path, diagnostics);
    const auto graph = document ? read_graph(*document, pass_types, diagnostics) : std::nullopt;
    EXPECT_TRUE(graph) << path;
    if (!graph) return {};
    CompileInput input;
    input.graph = &*graph;
    input.pass_types = &pass_types;
    input.device = &device;
    input.view_width = 640;
    input.view_height = 360;
    input.bound.assign(graph->resources.size(), bound);
    const auto compiled = compile(input, diagnostics);
    EXPECT_TRUE(compiled) << path << format_as_json(diagnostics);
    return compiled ? json::parse(plan_json(*graph, pass_types, *compiled)) : json();
  }
};

TEST_F(PlanSchema, AcceptsThePlanOfEveryShippedGraph) {
  uint32_t plans = 0;
  for (const std::string& file : dermis::shipped::graph_files()) {
    const std::string path = DERMIS_SOURCE_DIR "/" + file;
    for (const bool bound : {true, false}) {
      EXPECT_EQ(schema.first_problem(plan_of(path, bound)), "") << path << " bound: " << bound;
      ++plans;
    }
  }
  EXPECT_GE(plans, 4u);
}

// Every object of a plan is closed and complete: the schema rejects a missing key and an additional
// key.
void expect_closed(const SchemaFile& schema, const json& whole, json& part, const json& copy,
                   const std::string& where, uint32_t& tried) {
  if (part.is_array()) {
    if (!part.empty()) expect_closed(schema, whole, part[0], copy[0], where + "/0", tried);
    return;
  }
  if (!part.is_object()) return;
  for (auto it = copy.begin(); it != copy.end(); ++it) {
    expect_closed(schema, whole, part[it.key()], it.value(), where + "/" + it.key(), tried);
    // Not every reason has a name.
    if (it.key() == "name" && where.starts_with("/reasons")) continue;
    part.erase(it.key());
    EXPECT_FALSE(schema.accepts(whole)) << "without " << where << "/" << it.key();
    part[it.key() + "x"] = it.value();
    EXPECT_FALSE(schema.accepts(whole)) << "renamed " << where << "/" << it.key();
    part.erase(it.key() + "x");
    part[it.key()] = json::array({1});
    if (!it.value().is_array()) {
      EXPECT_FALSE(schema.accepts(whole)) << "an array at " << where << "/" << it.key();
    }
    part[it.key()] = it.value();
    ++tried;
  }
}

TEST_F(PlanSchema, AcceptsThePlanOfTwoQueues) {
  Diagnostics diagnostics;
  const auto document = parse_document("two.json", R"({ "dermis": 2, "name": "two",
  "imports": { "light": { "format": "rgba16f", "size": "view" } },
  "resources": { "a": { "format": "rgba16f", "size": "view", "mips": 2 }, "b": { "format": "rgba16f", "size": "view" },
    "c": { "format": "rgba16f", "size": "view" }, "out": { "format": "rgba16f", "size": "view" } },
  "passes": [
    { "pass": "first", "type": "subsurface.pyramid_down", "read": { "fine": "light" }, "write": { "coarse": "b" } },
    { "pass": "aside", "type": "subsurface.pyramid_down", "queue": "async", "read": { "fine": "b" }, "write": { "coarse": "c" } },
    { "pass": "part", "type": "subsurface.pyramid_down", "read": { "fine": "c" }, "write": { "coarse": "a#1" } },
    { "pass": "last", "type": "subsurface.pyramid_down", "read": { "fine": "a#1" }, "write": { "coarse": "out" } } ],
  "exports": ["out"] })",
                                       diagnostics);
  const auto graph = document ? read_graph(*document, pass_types, diagnostics) : std::nullopt;
  ASSERT_TRUE(graph) << format_as_json(diagnostics);
  CompileInput input;
  input.graph = &*graph;
  input.pass_types = &pass_types;
  input.device = &device;
  input.view_width = input.view_height = 64;
  input.single_queue = false;
  const auto compiled = compile(input, diagnostics);
  ASSERT_TRUE(compiled) << format_as_json(diagnostics);
  const json plan = json::parse(plan_json(*graph, pass_types, *compiled));
  EXPECT_EQ(schema.first_problem(plan), "");
  EXPECT_EQ(plan["passes"][1]["queue"], "async");
}

TEST_F(PlanSchema, RejectsMissingAndAdditionalKeys) {
  json whole = plan_of(DERMIS_SOURCE_DIR "/configs/graphs/burley.json", true);
  const json copy = whole;
  uint32_t tried = 0;
  expect_closed(schema, whole, whole, copy, "", tried);
  EXPECT_EQ(schema.first_problem(whole), "");
  EXPECT_GT(tried, 80u);
}

} // namespace
} // namespace dermis::testing
