#include "tests/framegraph/model_support.hpp"

#include "framegraph/model/expression.hpp"

namespace dermis {
namespace {

using namespace dermis::testing;

TEST(Graph, EveryDeclarationIsReadAndResolved) {
  const Read whole = read(whole_graph());
  ASSERT_TRUE(whole.graph) << all_messages(whole.diagnostics);
  EXPECT_TRUE(whole.diagnostics.list.empty()) << all_messages(whole.diagnostics);
  const Graph& graph = *whole.graph;
  EXPECT_EQ(graph.name, "whole");
  ASSERT_EQ(graph.settings.size(), 5u);
  EXPECT_EQ(graph.settings[0].type, SettingType::choice);
  EXPECT_TRUE(graph.settings[0].by_budget);
  EXPECT_EQ(graph.settings[0].default_value.integer, 1);
  EXPECT_EQ(graph.settings[1].default_value.integer, 16);
  EXPECT_EQ(graph.settings[1].minimum, 4.0);
  EXPECT_EQ(graph.settings[1].maximum, 64.0);
  EXPECT_EQ(graph.settings[1].unit, "samples");
  EXPECT_EQ(graph.settings[2].default_value.real, 1.5);
  EXPECT_EQ(graph.settings[2].note, "of the blur");
  EXPECT_EQ(graph.settings[3].default_value.integer, 1);
  EXPECT_EQ(graph.settings[4].options, (std::vector<std::string>{"plain", "fancy"}));
  EXPECT_EQ(graph.settings[4].where.line, 7u);
  EXPECT_EQ(graph.settings[4].where.pointer, "/settings/style");

  ASSERT_EQ(graph.resources.size(), 7u);
  const ResourceDeclaration& light = graph.resources[0];
  EXPECT_EQ(light.origin, Origin::imported);
  EXPECT_TRUE(light.exported);
  EXPECT_EQ(light.formats, (FormatList{Format::rgba16f, Format::rgba32f}));
  EXPECT_TRUE(graph.resources[1].optional);
  EXPECT_EQ(graph.resources[1].formats, (FormatList{Format::d32f, Format::d24, Format::d16,
                                                    Format::d24s8, Format::d32fs8, Format::r32f}));
  const ResourceDeclaration& half = graph.resources[3];
  EXPECT_EQ(half.size.base, SizeExpression::Base::view);
  EXPECT_EQ(half.size.x.numerator, 3);
  EXPECT_EQ(half.size.y.denominator, 4);
  EXPECT_EQ(half.size.rounding, Rounding::floor);
  EXPECT_EQ(half.size.align, 8u);
  EXPECT_EQ(half.size.border, 1u);
  EXPECT_EQ(half.mips, 0u);
  EXPECT_EQ(half.layers, 2u);
  const ResourceDeclaration& kept = graph.resources[4];
  EXPECT_EQ(kept.size.base, SizeExpression::Base::resource);
  EXPECT_EQ(kept.size.resource, (ResourceId{3}));
  EXPECT_EQ(kept.history.frames, 2u);
  EXPECT_EQ(kept.history.first, HistoryDeclaration::First::clear);
  EXPECT_EQ(kept.history.on_cut, HistoryDeclaration::OnCut::keep);
  EXPECT_EQ(kept.history.on_resize, HistoryDeclaration::OnResize::rescale);
  EXPECT_EQ(graph.resources[5].size.base, SizeExpression::Base::fixed);
  EXPECT_EQ(graph.resources[5].size.x.numerator, 64);
  EXPECT_EQ(graph.resources[5].size.y.numerator, 32);
  const ResourceDeclaration& list = graph.resources[6];
  EXPECT_EQ(list.type, ResourceType::buffer);
  EXPECT_EQ(list.stride, 4u);
  EXPECT_EQ(list.extra_elements, 4u);
  EXPECT_EQ(list.size.x.denominator, 8);

  ASSERT_EQ(graph.passes.size(), 4u);
  const PassDeclaration& blur = graph.passes[1];
  EXPECT_EQ(blur.type, (PassTypeId{0}));
  ASSERT_TRUE(blur.when.valid());
  ASSERT_EQ(graph.reads(blur).size(), 4u);
  EXPECT_EQ(graph.reads(blur)[3].port, 3u) << "the reading port of the two ports named history";
  EXPECT_EQ(graph.reads(blur)[3].frames_back, 2u);
  ASSERT_EQ(graph.writes(blur).size(), 2u);
  EXPECT_EQ(graph.writes(blur)[1].port, 5u);
  EXPECT_EQ(graph.writes(blur)[1].resource, (ResourceId{4}));
  ASSERT_EQ(blur.settings.size(), 4u);
  EXPECT_EQ(blur.settings[0].from, (SettingId{1}));
  EXPECT_EQ(blur.settings[1].literal.real, 2.0);
  EXPECT_EQ(blur.settings[1].literal.type, SettingType::real);
  EXPECT_EQ(blur.settings[3].literal.integer, 1);
  ASSERT_EQ(blur.otherwise.size(), 1u);
  EXPECT_EQ(blur.otherwise[0].output, (ResourceId{3}));
  EXPECT_EQ(blur.otherwise[0].instead, (ResourceId{0}));
  const PassDeclaration& copy = graph.passes[2];
  EXPECT_FALSE(copy.when.valid());
  EXPECT_EQ(copy.settings[0].literal.integer, 2);
  ASSERT_EQ(copy.after.size(), 1u);
  EXPECT_EQ(copy.after[0].after, (PassId{0}));
  EXPECT_EQ(copy.after[0].reason, "keeps captures in order");
}

TEST(Graph, TheShortestGraphIsAccepted) {
  const Read shortest = read(R"({ "dermis": 2, "name": "empty", "passes": [], "exports": [] })");
  EXPECT_TRUE(shortest.graph) << all_messages(shortest.diagnostics);
}

TEST(Graph, ASecondPassMayUpdateWhatTheFirstWrote) {
  const Read updated = read(
      R"({ "dermis": 2, "name": "g", "imports": { "a": { "format": "rgba16f", "size": "view" } },
    "resources": { "x": { "format": "rgba16f", "size": "view" } }, "passes": [
    { "pass": "one", "type": "test.blur", "read": { "source": "a" }, "write": { "target": "x" } },
    { "pass": "two", "type": "test.mix", "read": { "source": "a" }, "write": { "target": "x" } } ], "exports": ["x"] })");
  EXPECT_TRUE(updated.graph) << all_messages(updated.diagnostics);
}

TEST(Graph, PassesWithConditionsMayWriteTheSameResource) {
  const Read exclusive = read(
      R"({ "dermis": 2, "name": "g", "imports": { "a": { "format": "rgba16f", "size": "view" } },
    "settings": { "on": { "bool": true } }, "resources": { "x": { "format": "rgba16f", "size": "view" } }, "passes": [
    { "pass": "one", "type": "test.blur", "when": "on", "read": { "source": "a" }, "write": { "target": "x" } },
    { "pass": "two", "type": "test.blur", "when": "not on", "read": { "source": "a" }, "write": { "target": "x" } } ],
    "exports": ["x"] })");
  EXPECT_TRUE(exclusive.graph) << all_messages(exclusive.diagnostics);
}

TEST(Graph, ReaderMayPrecedeItsProducer) {
  const Read forward = read(
      R"({ "dermis": 2, "name": "g", "imports": { "a": { "format": "rgba16f", "size": "view" } },
    "resources": { "x": { "format": "rgba16f", "size": "view" } }, "passes": [
    { "pass": "late", "type": "test.mix", "read": { "source": "x" }, "write": { "target": "a" } },
    { "pass": "early", "type": "test.blur", "read": { "source": "a" }, "write": { "target": "x" } } ], "exports": ["a"] })");
  EXPECT_TRUE(forward.graph) << all_messages(forward.diagnostics);
}

// Every deletion of one line or one token is rejected with a diagnostic or accepted, and never
// crashes.
TEST(Graph, DamagedGraphsAreAcceptedOrExplained) {
  const std::string whole = whole_graph();
  const auto check = [](const std::string& text) {
    const Read damage = read(text);
    EXPECT_EQ(damage.graph.has_value(), !damage.diagnostics.has_errors()) << text;
    for (const Diagnostic& one : damage.diagnostics.list)
      format_for_people(damage.diagnostics, one);
  };
  for (size_t from = 0; from < whole.size(); ++from) {
    if (whole[from] != '"') continue;
    const size_t end = whole.find('"', from + 1);
    if (end == std::string::npos) break;
    for (const char* replacement :
         {"\"\"", "1", "[]", "{}", "\"light\"", "\"view\"", "null", "\"list@-1\"", "\"$mirror\""}) {
      check(whole.substr(0, from) + replacement + whole.substr(end + 1));
    }
    from = end;
  }
}

TEST(Graph, AlignedBuffers_AreRoundedUpToAMultiple) {
  Diagnostics diagnostics;
  const auto document = parse_document("graph.json", R"({ "dermis": 2, "name": "g",
  "imports": { "light": { "format": "rgba16f", "size": "view" } },
  "resources": { "list": { "buffer": { "stride": 4, "count": 1000, "align": 256 } } },
  "passes": [], "exports": ["light"] })",
                                       diagnostics);
  ASSERT_TRUE(document);
  const auto graph = read_graph(*document, pass_types(), diagnostics);
  ASSERT_TRUE(graph) << all_messages(diagnostics);
  const SizeExpression& size = graph->resources[1].size;
  EXPECT_EQ(size.x.numerator, 1024);
  EXPECT_EQ(size.y.numerator * size.align, 1u);
}

} // namespace
} // namespace dermis
