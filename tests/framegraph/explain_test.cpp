// Tests that exports of a plan are complete, well formed and identical bytes every time.

#include "framegraph/explain/names.hpp"
#include "framegraph/explain/plan_dot.hpp"
#include "framegraph/explain/plan_json.hpp"
#include "framegraph/explain/plan_text.hpp"
#include "framegraph/text/document.hpp"
#include "framegraph/text/json_writer.hpp"
#include "tests/framegraph/random_graph.hpp"
#include "tests/support/matchers.hpp"

#include <limits>

namespace dermis::testing {
namespace {

GraphBuilder sample() {
  GraphBuilder b{"import light", "history sum", "image unused", "export result"};
  b.boolean("smooth", true);
  b.pass("accumulate", "test.shade", {{"a", "light"}, {"b", "sum@-1"}}, {{"out", "sum"}}).when =
      b.when("smooth");
  b.pass("waste", "test.need", {{"a", "light"}}, {{"out", "unused"}});
  b.pass("show", "test.need", {{"a", "sum"}}, {{"out", "result"}});
  return b;
}

TEST(PlanJson, TheSameInputsGiveTheSameBytes) {
  for (uint64_t seed = 0; seed < 50; ++seed) {
    const auto first = random_graph(seed), second = random_graph(seed);
    const auto one = plan_json(first.graph, first.pass_types, compiled(first));
    EXPECT_EQ(one, plan_json(second.graph, second.pass_types, compiled(second)));
  }
}

TEST(PlanJson, IsValidJsonForEveryGraph) {
  for (uint64_t seed = 0; seed < 50; ++seed) {
    const auto b = random_graph(seed);
    Diagnostics diagnostics;
    EXPECT_TRUE(parse_document("plan", plan_json(b.graph, b.pass_types, compiled(b)), diagnostics))
        << seed;
  }
}

TEST(PlanJson, NamesWhatRunsAndWhatDoesNotAndWhy) {
  const auto b = sample();
  const auto text = plan_json(b.graph, b.pass_types, compiled(b));
  EXPECT_THAT(
      text,
      HasAll(
          R"("dermis_plan": 2)", R"({ "name": "smooth", "type": "bool", "value": true })",
          R"("mask": "0x100000000", "names": ["shader_sampled_read"])",
          R"("layout_at_start": ["undefined", "shader_read_only"])",
          R"({ "about": "pass", "index": 1, "name": "waste", "text": "culled: no bound export needs 'unused'" })"));
}

TEST(PlanText, ShowsEveryPassBarrierAndPlacement) {
  const auto b = sample();
  const auto text = plan_text(b.graph, b.pass_types, compiled(b));
  EXPECT_THAT(text, HasAll("2 of 3 passes run", "b <- sum@-1", "waste: culled",
                           "of history, at least", "returns 'result' to the host"));
}

TEST(PlanText, SaysWhyAPassRunsAndWhyInThisOrder) {
  const auto b = sample();
  const auto text = plan_text(b.graph, b.pass_types, compiled(b));
  EXPECT_THAT(text, HasAll("runs: 'show' reads its 'sum'",
                           "file order: at most 0 B of transients are alive at once"));
  CompileInput input = b.input();
  input.order = PassOrder::program;
  EXPECT_THAT(plan_text(b.graph, b.pass_types, compiled(b, input)),
              HasSubstr("requested by the caller"));
}

TEST(PlanText, NamesTheSettingsThatSwitchAPassOff) {
  auto b = sample();
  b.boolean("debug", false);
  b.image("picture");
  b.pass("draw", "test.need", {{"a", "light"}}, {{"out", "picture"}}).when = b.when("debug");
  EXPECT_THAT(plan_text(b.graph, b.pass_types, compiled(b)),
              HasSubstr("draw: off: its 'when' is false with debug = false"));
}

TEST(PlanText, NamesThePassThatNeedsAnEarlierBarrier) {
  GraphBuilder b{"import light", "import shade", "image first", "image second", "export result"};
  b.pass("begin", "test.need", {{"a", "light"}}, {{"out", "first"}});
  b.pass("middle", "test.need", {{"a", "first"}}, {{"out", "second"}});
  b.pass("end", "test.shade", {{"a", "shade"}, {"b", "second"}}, {{"out", "result"}});
  const auto text = plan_text(b.graph, b.pass_types, compiled(b));
  EXPECT_THAT(
      text, HasSubstr("acquires 'shade' from the host (for 'end': merged into this earlier batch"));
  CompileInput input = b.input();
  input.single_queue = false;
  b.graph.passes[1].async = true;
  EXPECT_THAT(plan_text(b.graph, b.pass_types, compiled(b, input)),
              HasSubstr("waits for point 1 of the async queue, after 'middle'"));
}

TEST(PlanText, ExplainsTheRequestedOptions) {
  auto b = sample();
  b.pass("watch", "test.probe", {{"a", "light"}}, {});
  EXPECT_THAT(plan_text(b.graph, b.pass_types, compiled(b)),
              HasSubstr("runs: its pass type has side effects"));
  CompileInput input = b.input();
  input.cull = false;
  EXPECT_THAT(plan_text(b.graph, b.pass_types, compiled(b, input)),
              HasSubstr("runs: culling is disabled"));
  input = b.input();
  input.order = PassOrder::random;
  EXPECT_THAT(plan_text(b.graph, b.pass_types, compiled(b, input)), HasSubstr("random order"));
}

TEST(PlanText, RandomGraphs_EveryReasonHasText) {
  for (uint64_t seed = 0; seed < 60; ++seed) {
    const auto b = random_graph(seed);
    CompileInput in_random_order = b.input(), whole = b.input();
    in_random_order.order = PassOrder::random;
    in_random_order.order_seed = seed;
    whole.cull = false;
    for (const CompileInput& input : {b.input(), in_random_order, whole}) {
      const auto json = plan_json(b.graph, b.pass_types, compiled(b, input));
      EXPECT_THAT(json, Not(HasSubstr("\"text\": \"\""))) << seed;
      EXPECT_THAT(json, Not(HasSubstr("unknown"))) << seed;
    }
  }
}

TEST(PlanDot, DrawsPassesAndResourcesAndEscapesNames) {
  auto b = sample();
  b.graph.passes[0].name = "say \"hi\"";
  const auto dot = plan_dot(b.graph, b.pass_types, compiled(b));
  EXPECT_THAT(dot, HasAll("digraph \"test\" {", R"(say \"hi\")", "style=dashed", "color=gray"));
}

TEST(Names, UnknownBitsAreWrittenAsNumbers) {
  EXPECT_EQ(stage_text(stage::compute_shader | 0x4), "0x4|compute_shader");
  EXPECT_EQ(access_text(0), "none");
  EXPECT_EQ(layout_name(Layout::general), "general");
  EXPECT_EQ(bytes_text(1023), "1023 B");
  EXPECT_EQ(bytes_text(1536), "1.5 KiB");
}

TEST(JsonWriter, EscapesNestsAndRejectsNonFiniteNumbers) {
  JsonWriter out;
  out.open_object().member("text", "a\"\\\n\x01").key("list").open_array(true).value(1).value(-2.5);
  out.value(std::numeric_limits<double>::infinity()).value(UINT64_MAX).close();
  out.key("empty").open_object().close().close();
  EXPECT_EQ(std::move(out).finish(),
            "{\n  \"text\": \"a\\\"\\\\\\n\\u0001\",\n  \"list\": [1, -2.5, null, "
            "18446744073709551615],\n  \"empty\": {}\n}\n");
}

} // namespace
} // namespace dermis::testing
