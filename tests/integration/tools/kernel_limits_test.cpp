// Tests rows of kernels and limits files, without a device.
#include "integration/tools/command/kernels/limits.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dermis::test {
namespace {

using namespace dermis::tools;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

vulkan::PipelineExecutable executable(std::vector<vulkan::PipelineStatistic> statistics) {
  return {"main", 64, std::move(statistics), "assembly"};
}

TEST(KernelRows, StatisticsGetCommonNames) {
  const auto rows = make_rows("sap/up", std::vector{executable({{"VGPRs", "", 48},
                                                                {"Spilled VGPRs", "", 3},
                                                                {"LDS size", "", 512},
                                                                {"Latency", "", 77}})});
  ASSERT_THAT(rows, SizeIs(1));
  EXPECT_EQ(rows[0].kernel, "sap/up");
  EXPECT_EQ(rows[0].program, "");
  EXPECT_EQ(rows[0].value(KernelValue::vgprs), 48);
  EXPECT_EQ(rows[0].value(KernelValue::spilled_vgprs), 3);
  EXPECT_EQ(rows[0].value(KernelValue::shared_bytes), 512);
  EXPECT_EQ(rows[0].value(KernelValue::subgroup_size), 64);
  EXPECT_EQ(rows[0].value(KernelValue::occupancy), std::nullopt);
  EXPECT_THAT(rows[0].statistics, SizeIs(4));
}

// Values as NVIDIA 580 reports them.
TEST(KernelRows, LocalMemoryBeyond32Bits) {
  const auto rows = make_rows("k", std::vector{executable({{"Register Count", "", 48},
                                                           {"Local Memory Size", "", 68719476752},
                                                           {"Shared Memory Size", "", 2304}})});
  ASSERT_THAT(rows, SizeIs(1));
  EXPECT_EQ(rows[0].value(KernelValue::vgprs), 48);
  EXPECT_EQ(rows[0].value(KernelValue::scratch_bytes), 16);
  EXPECT_EQ(rows[0].value(KernelValue::shared_bytes), 2304);
}

TEST(KernelRows, EachProgramHasARow) {
  std::vector programs{executable({{"Instruction Count", "", 10}}),
                       executable({{"Instruction Count", "", 20}})};
  programs[0].name = "SIMD8";
  programs[1].name = "SIMD16";
  const auto rows = make_rows("k", programs);
  ASSERT_THAT(rows, SizeIs(2));
  EXPECT_EQ(rows[1].program, "SIMD16");
  EXPECT_EQ(rows[1].value(KernelValue::instructions), 20);
}

TEST(KernelRows, WithoutStatisticsOneRowRemains) {
  const auto rows = make_rows("k", {});
  ASSERT_THAT(rows, SizeIs(1));
  EXPECT_EQ(rows[0].value(KernelValue::vgprs), std::nullopt);
}

TEST(KernelLimits, StarsInPatterns) {
  const struct {
    const char *pattern, *text;
    bool matches;
  } cases[] = {
      {"sap", "sap", true},          {"sap", "sap2", false},        {"*", "", true},
      {"sap/*", "sap/up", true},     {"sap/*", "burley/up", false}, {"*up", "sap/up_up", true},
      {"s*p*d", "sap/down/d", true}, {"s*p*d", "sap/down", false},  {"", "a", false}};
  for (const auto& one : cases)
    EXPECT_EQ(matches_pattern(one.pattern, one.text), one.matches)
        << one.pattern << " on " << one.text;
}

struct Read {
  Diagnostics diagnostics;
  std::optional<std::vector<LimitRule>> rules;
};

Read read(const std::string& rules) {
  Read out;
  const std::string text = "{ \"dermis_kernel_limits\": 1, \"rules\": [\n" + rules + "\n] }";
  const auto document = parse_document("limits.json", text, out.diagnostics);
  if (document) out.rules = read_limits(*document, out.diagnostics);
  return out;
}

TEST(KernelLimits, MistakesInTheFileHavePositions) {
  const struct {
    const char *rule, *message;
  } cases[] = {
      {R"({ "kernel": "*", "max": { "vgpr": 1 } })", "limits.json:2:27: error[D0103 unknown_key]"},
      {R"({ "kernel": "*", "max": { "vgpr": 1 } })", "did you mean 'vgprs'"},
      {R"({ "graph": "*", "max": { "vgprs": 1 } })", "a graph has no value 'vgprs'"},
      {R"({ "kernel": "*", "graph": "*", "max": { "vgprs": 1 } })",
       "give one of 'kernel' and 'graph'"},
      {R"({ "kernel": "*" })", "a rule needs a limit"},
      {R"({ "kernel": "*", "max": { "vgprs": "many" } })",
       "limits.json:2:36: error[D0104 wrong_type]"},
      {R"({ "kernel": [], "max": { "vgprs": 1 } })", "has 0 patterns"},
      {R"({ "kernel": "*", "max": { "vgprs": { "goal": 80 } } })", "D0105 missing_key"},
      {R"({ "kernel": "*", "max": { "vgprs": { "goal": 80, "now": 72 } } })",
       "'now' reaches the goal"},
      {R"({ "kernel": "*", "min": { "occupancy": { "goal": 8, "now": 9 } } })",
       "'now' reaches the goal"},
      {R"({ "kernel": "*", "max": { "vgprs": 1 }, "colour": 1 })", "D0103 unknown_key"},
  };
  for (const auto& one : cases) {
    const Read read_back = read(one.rule);
    EXPECT_FALSE(read_back.rules) << one.rule;
    std::string all;
    for (const Diagnostic& diagnostic : read_back.diagnostics.list)
      all += format_for_people(read_back.diagnostics, diagnostic) + "\n";
    EXPECT_THAT(all, HasSubstr(one.message)) << one.rule;
  }
}

// A kernel with two values.
KernelRow row(const std::string& kernel, double vgprs, double occupancy) {
  KernelRow made;
  made.kernel = kernel;
  made.values[static_cast<size_t>(KernelValue::vgprs)] = vgprs;
  made.values[static_cast<size_t>(KernelValue::occupancy)] = occupancy;
  return made;
}

std::vector<std::string> texts(const std::vector<LimitFinding>& findings) {
  std::vector<std::string> all;
  for (const LimitFinding& finding : findings)
    all.push_back(finding.text());
  return all;
}

LimitsCheck check(const std::string& rules, const std::vector<KernelRow>& kernels,
                  const std::vector<GraphCounts>& graphs = {}) {
  const Read read_back = read(rules);
  EXPECT_TRUE(read_back.rules) << rules;
  if (!read_back.rules) return {};
  return check_limits(*read_back.rules, {"Null hardware (RADV NAVI21)", "radv Mesa 22.3.6"},
                      kernels, graphs);
}

TEST(KernelLimits, ExceededLimitsNameKernelValueAndLimit) {
  const LimitsCheck result = check(
      R"({ "device": "*NAVI21*", "driver": ["intel*", "radv*"], "kernel": "sap/*",
           "max": { "vgprs": 80 }, "min": { "occupancy": 8 } })",
      {row("sap/up", 96, 4), row("sap/down", 80, 8), row("burley/scatter", 200, 1)});
  EXPECT_TRUE(result.device_known);
  EXPECT_EQ(result.checked, 4u);
  EXPECT_THAT(texts(result.exceeded), ElementsAre("sap/up: occupancy is 4, at least 8 is allowed",
                                                  "sap/up: vgprs is 96, at most 80 is allowed"));
}

TEST(KernelLimits, TheLastMatchingRuleDecides) {
  const LimitsCheck result = check(R"({ "kernel": "*", "max": { "vgprs": 80 } },
                                      { "kernel": "sap/up", "max": { "vgprs": 96 } },
                                      { "device": "*VEGA*", "kernel": "*", "max": { "vgprs": 1 } })",
                                   {row("sap/up", 96, 4), row("sap/down", 96, 4)});
  EXPECT_THAT(texts(result.exceeded), ElementsAre("sap/down: vgprs is 96, at most 80 is allowed"));
}

TEST(KernelLimits, PresentValuesAreAcceptedUntilTheGoal) {
  const std::string rule = R"({ "kernel": "*", "max": { "vgprs": { "goal": 80, "now": 200 } } })";
  const LimitsCheck result = check(rule, {row("worse", 201, 1), row("equal", 200, 1),
                                          row("better", 100, 1), row("there", 80, 1)});
  EXPECT_THAT(texts(result.exceeded),
              ElementsAre("worse: vgprs is 201, at most 200 is allowed (goal 80)"));
  ASSERT_THAT(result.open, SizeIs(2));
  EXPECT_EQ(result.open[0].subject, "equal");
  EXPECT_EQ(result.open[1].subject, "better");
  ASSERT_THAT(result.loose, SizeIs(2));
  EXPECT_EQ(result.loose[0].subject, "better");
  EXPECT_EQ(result.loose[1].subject, "there");
}

TEST(KernelLimits, ALimitOnAnUnreportedValueIsExceeded) {
  KernelRow silent;
  silent.kernel = "k";
  const LimitsCheck result = check(R"({ "kernel": "*", "max": { "vgprs": 80 } })", {silent});
  EXPECT_THAT(texts(result.exceeded), ElementsAre(HasSubstr("does not report vgprs")));
}

TEST(KernelLimits, AFileWithoutRulesForTheDeviceSaysSo) {
  const LimitsCheck result =
      check(R"({ "device": "*VEGA*", "kernel": "*", "max": { "vgprs": 1 } })", {row("k", 200, 1)});
  EXPECT_FALSE(result.device_known);
  EXPECT_THAT(result.exceeded, IsEmpty());
}

TEST(KernelLimits, GraphsHaveLimits) {
  GraphCounts graph;
  graph.graph = "sap";
  graph.dispatches = 21;
  graph.read_bytes = 100;
  graph.written_bytes = 64;
  const LimitsCheck result =
      check(R"({ "graph": "sap", "max": { "dispatches": 14, "bytes_per_pixel": 164 } },
                                      { "graph": "burley", "max": { "dispatches": 1 } })",
            {}, {graph});
  EXPECT_THAT(texts(result.exceeded),
              ElementsAre("graph sap: dispatches is 21, at most 14 is allowed"));
  EXPECT_EQ(result.checked, 2u);
}

} // namespace
} // namespace dermis::test
