// Tests subresource ranges: mips and layers that ports distinguish have their own versions,
// lifetimes, layouts and barriers.

#include "tests/framegraph/graph_builder.hpp"

#include "framegraph/model/image_range.hpp"

#include <fmt/format.h>

namespace dermis::testing {
namespace {

// Builds light -> chain#0 -> chain#1 -> chain#2, then the whole chain -> result.
GraphBuilder pyramid() {
  GraphBuilder b;
  b.import("light");
  b.image("chain").mips = 3;
  b.exported("result");
  b.pass("base", "test.need", {{"a", "light"}}, {{"out", "chain#0"}});
  b.pass("down1", "test.need", {{"a", "chain#0"}}, {{"out", "chain#1"}});
  b.pass("down2", "test.need", {{"a", "chain#1"}}, {{"out", "chain#2"}});
  b.pass("gather", "test.need", {{"a", "chain"}}, {{"out", "result"}});
  return b;
}

const PlanAccess& access_of(const GraphBuilder& b, const Plan& plan, const std::string& pass,
                            uint32_t port) {
  for (const PlanPass& one : plan.passes)
    for (uint32_t a = one.first_access; a < one.first_access + one.access_count; ++a)
      if (one.declared == b.pass_id(pass) && plan.accesses[a].port == port) return plan.accesses[a];
  ADD_FAILURE() << pass << " has nothing at port " << port;
  return plan.accesses.front();
}

std::vector<PlanBarrier> barriers_before(const GraphBuilder& b, const Plan& plan,
                                         const std::string& pass, const std::string& resource) {
  std::vector<PlanBarrier> found;
  for (const PlanPass& one : plan.passes)
    for (uint32_t i = one.first_barrier; i < one.first_barrier + one.barrier_count; ++i)
      if (one.declared == b.pass_id(pass) &&
          plan.resources[plan.barriers[i].resource].declared == b.resource(resource))
        found.push_back(plan.barriers[i]);
  return found;
}

TEST(ImageRange, ReferenceText_RoundTrips) {
  for (const char* text :
       {"", "#0", "#14", "#1..3", "#2..", "[0]", "[2047]", "[1..4]", "#0[1]", "#1..2[3..]"}) {
    const auto image_range = parse_image_range(text);
    ASSERT_TRUE(image_range) << text;
    EXPECT_EQ(image_range_text(*image_range), text);
  }
  EXPECT_TRUE(parse_image_range("")->whole());
  EXPECT_TRUE(parse_image_range("#0..[0..]")->whole());
  for (const char* text : {"#", "#-1", "#15", "#3..1", "#1.2", "#1...2", "[", "[]", "[0", "0]",
                           "[2048]", "[0]#1", "#1[0]x", " #1", "#1 ", "#99999999999", "#1..99"})
    EXPECT_FALSE(parse_image_range(text)) << text;
}

TEST(Subresources, OneMipIsReadWhileAnotherIsWritten) {
  const auto b = pyramid();
  const Plan plan = compiled(b).plan;
  EXPECT_EQ(pass_names(b, plan), "base down1 down2 gather");
  const PlanAccess &read = access_of(b, plan, "down1", 0),
                   &written = access_of(b, plan, "down1", 1);
  EXPECT_EQ(read.range, (SubresourceRange{0, 1, 0, 1}));
  EXPECT_EQ(read.layout, Layout::shader_read_only);
  EXPECT_EQ(written.range, (SubresourceRange{1, 1, 0, 1}));
  EXPECT_EQ(written.layout, Layout::general);
  EXPECT_EQ(access_of(b, plan, "gather", 0).range, (SubresourceRange{0, 3, 0, 1}));
  // Earlier barriers have made the other mips readable.
  const auto last = barriers_before(b, plan, "gather", "chain");
  ASSERT_EQ(last.size(), 1u);
  EXPECT_EQ(last[0].range, (SubresourceRange{2, 1, 0, 1}));
}

// Builds light -> kept#0 -> kept#1; `result` reads both mips of the previous frame.
GraphBuilder kept_mips() {
  GraphBuilder b;
  b.import("light");
  b.history("kept", 1).mips = 2;
  b.exported("result");
  b.pass("first", "test.need", {{"a", "light"}}, {{"out", "kept#0"}});
  b.pass("second", "test.need", {{"a", "kept#0"}}, {{"out", "kept#1"}});
  b.pass("show", "test.shade", {{"a", "kept#0@-1"}, {"b", "kept#1@-1"}}, {{"out", "result"}});
  return b;
}

TEST(Subresources, HistoryMipsKeepSeparateLayouts) {
  const Plan plan = compiled(kept_mips()).plan;
  ASSERT_EQ(plan.histories.size(), 1u);
  EXPECT_EQ(plan.histories[0].range_count, 2u);
  EXPECT_THAT(plan.history_ranges,
              ElementsAre(SubresourceRange{0, 1, 0, 1}, SubresourceRange{1, 1, 0, 1}));
  // Mip 0 keeps the layout of its last read; mip 1 keeps the layout of its write.
  EXPECT_THAT(plan.history_layouts, ElementsAre(Layout::undefined, Layout::undefined,
                                                Layout::shader_read_only, Layout::general));
}

TEST(Subresources, HistoryOfUnwrittenMip_IsRejected) {
  auto b = kept_mips();
  b.graph.resources[1].mips = 3;
  b.exported("late");
  b.pass("needs", "test.need", {{"a", "kept#2@-1"}}, {{"out", "late"}});
  rejected_once(b, DiagnosticId::history_unwritten,
                "'kept#2@-1', but no pass that is on writes 'kept#2'");
}

// No pass writes the history, so both ports read their substitute in every frame.
TEST(Subresources, UnwrittenDividedHistory_IsReplaced) {
  GraphBuilder b{"import light", "history kept", "export late", "export required"};
  b.graph.resources[b.resource("kept").value].mips = 2;
  b.boolean("on", false);
  for (const char* mip : {"kept#0", "kept#1"})
    b.pass(mip, "test.need", {{"a", "light"}}, {{"out", mip}}).when = b.when("on");
  b.pass("late", "test.shade", {{"a", "kept@-1?light"}, {"b", "kept#0@-1?light"}},
         {{"out", "late"}});
  b.pass("needs", "test.need", {{"a", "kept@-1?light"}}, {{"out", "required"}});
  const Plan plan = compiled(b).plan;
  EXPECT_EQ(pass_names(b, plan), "late needs");
  EXPECT_EQ(plan.passes[0].access_count, 3u);
}

// Expects the diagnostic for an optional port that reads a mip chain with unwritten mips.
Diagnostic half_written(const GraphBuilder& b, DiagnosticId id = DiagnosticId::read_before_write) {
  const auto errors = rejected(b);
  EXPECT_EQ(errors.size(), 1u);
  EXPECT_EQ(errors[0].id, id);
  return errors[0];
}

TEST(Subresources, PartlyWrittenChain_AtOptionalPort_IsRejected) {
  GraphBuilder b;
  b.import("light");
  b.image("chain").mips = 0; // A full chain has 7 mips.
  b.exported("result");
  b.pass("base", "test.need", {{"a", "light"}}, {{"out", "chain#0"}});
  b.pass("third", "test.need", {{"a", "light"}}, {{"out", "chain#2"}});
  b.pass("gather", "test.shade", {{"a", "chain"}}, {{"out", "result"}});
  const Diagnostic one = half_written(b);
  EXPECT_THAT(one.text,
              HasSubstr("pass 'gather', port 'a' reads 'chain', but no pass that is on writes "
                        "'chain#1' or 'chain#3..6'"));
  // The related place is the declaration, because no pass writes the missing mip.
  EXPECT_EQ(one.related.size(), 1u);
}

TEST(Subresources, MissingPart_NamesTheDisabledWriter) {
  auto b = pyramid();
  b.boolean("on", false);
  b.graph.passes[2].when = b.when("on");
  const Diagnostic one = half_written(b);
  EXPECT_THAT(one.text, HasSubstr("'chain#2'"));
  ASSERT_EQ(one.related.size(), 2u);
  EXPECT_THAT(one.related[1].second, HasSubstr("'down2' writes it and is off"));
}

TEST(Subresources, PartlyWrittenLayersAndHistories_AreRejected) {
  GraphBuilder layers;
  layers.import("light");
  layers.image("cube").layers = 6;
  layers.exported("result");
  layers.pass("some", "test.need", {{"a", "light"}}, {{"out", "cube[0..3]"}});
  layers.pass("gather", "test.shade", {{"a", "cube"}}, {{"out", "result"}});
  EXPECT_THAT(half_written(layers).text, HasSubstr("'cube[4..5]'"));
  auto history = kept_mips();
  history.graph.resources[1].mips = 3;
  history.read(2, 0).range = {};
  EXPECT_THAT(half_written(history, DiagnosticId::history_unwritten).text,
              HasSubstr("reads 'kept@-1', but no pass that is on writes 'kept#2'"));
}

TEST(Subresources, OptionalPort_NothingWritten_StaysUnbound) {
  auto b = pyramid();
  b.boolean("on", false);
  b.exported("second");
  for (uint32_t pass = 0; pass < 3; ++pass)
    b.graph.passes[pass].when = b.when("on");
  b.graph.passes.pop_back();
  b.pass("maybe", "test.shade", {{"a", "chain"}, {"b", "light"}, {"c", "chain#1"}},
         {{"out", "second"}});
  b.pass("show", "test.need", {{"a", "second"}}, {{"out", "result"}});
  const auto plan = compiled(b);
  const std::string text = reasons(b, plan, Reason::About::pass, 3);
  const std::string unbound = "optional port 'a' is unbound";
  ASSERT_NE(text.find(unbound), std::string::npos) << text;
  EXPECT_EQ(text.find(unbound), text.rfind(unbound)) << text;
}

TEST(Subresources, UnreadPartIsCulled) {
  auto b = pyramid();
  b.read(3, 0).range = *parse_image_range("#0..1");
  const auto plan = compiled(b);
  EXPECT_EQ(pass_names(b, plan.plan), "base down1 gather");
  EXPECT_THAT(reasons(b, plan, Reason::About::pass, 2), HasSubstr("culled"));
}

TEST(Subresources, ReadOfUnwrittenPart_IsRejected) {
  auto b = pyramid();
  b.graph.resources[1].mips = 4;
  const Diagnostic error = rejected_once(b, DiagnosticId::read_before_write, "'chain'");
  EXPECT_EQ(error.where.line, b.graph.place_of(b.read(3, 0)).line);
  EXPECT_EQ(error.related.size(), 1u) << "the declaration: no pass writes mip 3";
}

TEST(Subresources, OnlyWritersOfTheMissingMipAreListed) {
  auto b = pyramid();
  b.graph.resources[1].mips = 4;
  b.boolean("deep", false);
  b.pass("down3", "test.need", {{"a", "chain#2"}}, {{"out", "chain#3"}}).when = b.when("deep");
  std::swap(b.graph.passes[3], b.graph.passes[4]);
  const Diagnostic error = rejected_once(b, DiagnosticId::read_before_write);
  ASSERT_EQ(error.related.size(), 2u);
  EXPECT_THAT(error.related[1].second, HasSubstr("'down3' writes it and is off"));
}

TEST(Subresources, TwoWritersOfOneMipAreRejectedOnce) {
  auto b = pyramid();
  b.pass("again", "test.need", {{"a", "light"}}, {{"out", "chain#0..1"}});
  rejected_once(b, DiagnosticId::second_producer);
}

TEST(Subresources, MipsBeyondTheViewAreRejected) {
  auto b = pyramid();
  b.graph.resources[1].mips = 0; // mips = 0 declares the full chain; 64 texels have 7 mips.
  b.pass("far", "test.need", {{"a", "chain#7"}}, {{"out", "chain#8[1]"}});
  const auto errors = rejected(b);
  ASSERT_EQ(errors.size(), 2u);
  for (const Diagnostic& error : errors) {
    EXPECT_EQ(error.id, DiagnosticId::subresource_missing);
    EXPECT_THAT(error.text, HasSubstr("at 64x64 texels 'chain' has 7 mips and 1 layer"));
    EXPECT_EQ(error.related.size(), 1u);
  }
  EXPECT_EQ(errors[0].where.line, b.graph.place_of(b.read(4, 0)).line);
  EXPECT_THAT(errors[1].text, HasSubstr("'chain#8[1]'"));
}

TEST(Subresources, OpenRangeEndsWithTheImage) {
  for (const uint32_t side : {8u, 64u}) {
    auto b = pyramid();
    b.graph.resources[1].mips = 0;
    b.pass("rest", "test.fill", {}, {{"target", "chain#3.."}});
    const auto input = b.input(side, side);
    const Plan plan = compiled(b, input).plan;
    EXPECT_EQ(access_of(b, plan, "rest", 0).range.mips, side == 8 ? 1u : 4u);
  }
}

TEST(Subresources, OtherwiseForMipsOrLayers_IsRejected) {
  auto b = pyramid();
  b.boolean("small", true);
  b.image("half");
  b.graph.passes[0].when = b.when("small", false);
  b.otherwise(b.graph.passes[0], "chain", "light");
  const auto errors = rejected(b);
  ASSERT_GE(errors.size(), 1u);
  EXPECT_EQ(errors[0].id, DiagnosticId::otherwise_mismatch);
  EXPECT_THAT(errors[0].text, HasSubstr("ports name mips or layers of 'chain'"));
}

TEST(Subresources, TooManySubresources_AreRejected) {
  GraphBuilder b;
  auto& array = b.image("array");
  array.layers = 256;
  array.mips = 4;
  b.exported("result");
  b.pass("coarse", "test.fill", {}, {{"target", "array#2"}});
  for (uint32_t l = 0; l < 256; ++l)
    b.pass(fmt::format("p{}", l), "test.fill", {}, {{"target", fmt::format("array#0[{}]", l)}});
  b.pass("show", "test.need", {{"a", "array#0"}}, {{"out", "result"}});
  rejected_once(b, DiagnosticId::limit_exceeded, "1024 different subresource ranges of 'array'");
}

TEST(Subresources, EqualTransitionsShareABarrier) {
  GraphBuilder b;
  auto& image = b.image("image");
  image.mips = image.layers = 2;
  b.exported("result");
  b.pass("fill", "test.fill", {}, {{"target", "image"}});
  b.pass("touch", "test.update", {}, {{"image", "image#1[0]"}});
  b.pass("show", "test.need", {{"a", "image"}}, {{"out", "result"}});
  const Plan plan = compiled(b).plan;
  const auto first = barriers_before(b, plan, "fill", "image");
  ASSERT_EQ(first.size(), 1u);
  EXPECT_EQ(first[0].range, (SubresourceRange{0, 2, 0, 2}));
  const auto second = barriers_before(b, plan, "touch", "image");
  uint32_t subresources = 0;
  for (const PlanBarrier& barrier : second)
    subresources += barrier.range.mips * barrier.range.layers;
  for (const PlanBarrier& barrier : barriers_before(b, plan, "show", "image"))
    subresources += barrier.range.mips * barrier.range.layers;
  EXPECT_EQ(subresources, 5u); // The mip that is written in place counts twice.
}

TEST(Subresources, OnePortUsesOneLayout) {
  GraphBuilder b;
  b.image("image").mips = 2;
  b.exported("result");
  b.pass("fill", "test.fill", {}, {{"target", "image"}});
  b.pass("mix", "test.update", {{"own", "image"}}, {{"image", "image#1"}});
  b.pass("show", "test.need", {{"a", "image"}}, {{"out", "result"}});
  const Plan plan = compiled(b).plan;
  EXPECT_EQ(access_of(b, plan, "mix", 2).layout, Layout::general);
  EXPECT_EQ(access_of(b, plan, "mix", 2).range.mips, 2u);
  EXPECT_EQ(access_of(b, plan, "mix", 1).layout, Layout::general);
}

} // namespace
} // namespace dermis::testing
