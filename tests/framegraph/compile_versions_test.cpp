// Tests versions, conditions, culling and order: which passes run, in which order, and which graphs
// are rejected.

#include "tests/framegraph/graph_builder.hpp"

namespace dermis::testing {
namespace {

// Builds light (import) -> blur -> result (export).
GraphBuilder chain() {
  GraphBuilder b{"import light", "image blurred", "export result"};
  b.pass("blur", "test.shade", {{"a", "light"}}, {{"out", "blurred"}});
  b.pass("finish", "test.shade", {{"a", "blurred"}}, {{"out", "result"}});
  return b;
}

TEST(Culling, UnneededPassAndItsProducersDoNotRun) {
  GraphBuilder b = chain();
  b.image("x");
  b.image("y");
  b.pass("make_x", "test.shade", {{"a", "light"}}, {{"out", "x"}});
  b.pass("make_y", "test.shade", {{"a", "x"}}, {{"out", "y"}});
  const auto plan = compiled(b);
  EXPECT_EQ(pass_names(b, plan.plan), "blur finish");
  EXPECT_THAT(reasons(b, plan, Reason::About::pass, b.pass_id("make_y").value),
              HasSubstr("culled: no bound export needs 'y'"));
  EXPECT_THAT(reasons(b, plan, Reason::About::pass, b.pass_id("make_x").value),
              HasSubstr("culled"));
  EXPECT_THAT(reasons(b, plan, Reason::About::pass, b.pass_id("blur").value),
              HasSubstr("'finish' reads its 'blurred'"));
}

TEST(Culling, APassWithSideEffectsKeepsWhatItReads) {
  GraphBuilder b = chain();
  b.image("x");
  b.pass("make_x", "test.shade", {{"a", "light"}}, {{"out", "x"}});
  b.pass("look", "test.probe", {{"a", "x"}}, {});
  EXPECT_EQ(pass_names(b, compiled(b).plan), "blur finish make_x look");
}

TEST(Culling, UnboundOptionalExportKeepsNothingAlive) {
  GraphBuilder b = chain();
  b.exported("debug").optional = true;
  b.pass("draw_debug", "test.shade", {{"a", "blurred"}}, {{"out", "debug"}});
  EXPECT_EQ(pass_names(b, compiled(b).plan), "blur finish draw_debug");
  auto input = b.input();
  input.bound.assign(b.graph.resources.size(), true);
  input.bound[b.resource("debug").value] = false;
  EXPECT_EQ(pass_names(b, compiled(b, input).plan), "blur finish");
}

TEST(Culling, UnboundExportReadInside_BecomesTransient) {
  GraphBuilder b = chain();
  b.exported("debug").optional = true;
  b.exported("second");
  b.pass("draw_debug", "test.shade", {{"a", "blurred"}}, {{"out", "debug"}});
  b.pass("use", "test.shade", {{"a", "debug"}}, {{"out", "second"}});
  auto input = b.input();
  input.bound.assign(b.graph.resources.size(), true);
  input.bound[b.resource("debug").value] = false;
  const auto plan = compiled(b, input);
  for (const PlanResource& resource : plan.plan.resources)
    if (resource.declared == b.resource("debug")) {
      EXPECT_FALSE(resource.exported);
      EXPECT_NE(resource.first_instance, no_instance);
      // Slots (light, result, debug, second) do not depend on which of them are bound.
      EXPECT_EQ(resource.slot, 2);
    }
}

// A type whose optional ports extend an export that an earlier pass has begun.
const Port extending_ports[] = {{"light", Usage::sampled_image, false, "texture2D", ""},
                                {"before", Usage::sampled_image, true, "texture2D", "", {}, true},
                                {"out", Usage::storage_image_write, false, "image2D", ""},
                                {"debug", Usage::storage_image_write, true, "image2D", ""}};

TEST(Culling, UnboundExportOnlyExtended_IsNotWritten) {
  GraphBuilder b = chain();
  PassType type;
  type.name = "test.extend";
  type.ports = extending_ports;
  b.pass_types.add(type);
  b.exported("debug").optional = true;
  b.exported("second");
  b.pass("draw_debug", "test.shade", {{"a", "blurred"}}, {{"out", "debug"}});
  b.pass("extend", "test.extend", {{"light", "blurred"}, {"before", "debug"}},
         {{"out", "second"}, {"debug", "debug"}});
  auto input = b.input();
  input.bound.assign(b.graph.resources.size(), true);
  EXPECT_EQ(pass_names(b, compiled(b, input).plan), "blur finish draw_debug extend");
  EXPECT_EQ(compiled(b, input).plan.passes.back().access_count, 4u);
  input.bound[b.resource("debug").value] = false;
  const auto plan = compiled(b, input);
  EXPECT_EQ(pass_names(b, plan.plan), "blur finish extend");
  EXPECT_EQ(plan.plan.passes.back().access_count, 2u);
  EXPECT_THAT(reasons(b, plan, Reason::About::pass, b.pass_id("extend").value),
              HasSubstr("optional port 'debug' is unbound"));
}

TEST(Culling, UnboundExportThatAPassNeeds_IsWritten) {
  GraphBuilder b = chain();
  PassType drawing, continuing;
  drawing.name = "test.draw";
  drawing.ports = extending_ports;
  continuing.name = "test.continue";
  // As test.draw, but the pass cannot run without the earlier contents.
  std::vector<Port> ports(std::begin(extending_ports), std::end(extending_ports));
  ports[1].optional = false;
  continuing.ports = ports;
  b.pass_types.add(drawing);
  b.pass_types.add(continuing);
  b.exported("debug").optional = true;
  b.exported("first");
  b.exported("second");
  b.pass("draw", "test.draw", {{"light", "blurred"}}, {{"out", "first"}, {"debug", "debug"}});
  b.pass("go_on", "test.continue", {{"light", "blurred"}, {"before", "debug"}},
         {{"out", "second"}, {"debug", "debug"}});
  auto input = b.input();
  input.bound.assign(b.graph.resources.size(), true);
  for (const bool bound : {true, false}) {
    input.bound[b.resource("debug").value] = bound;
    const Plan plan = compiled(b, input).plan;
    EXPECT_EQ(pass_names(b, plan), "blur finish draw go_on");
    EXPECT_EQ(plan.passes[2].access_count, 3u) << bound;
    EXPECT_EQ(plan.passes[3].access_count, 4u) << bound;
  }
}

TEST(Culling, ARequiredPortOfALivePassNeedsItsImport) {
  GraphBuilder b = chain();
  b.import("mask").optional = true;
  b.image("masked");
  b.exported("other");
  b.pass("apply_mask", "test.need", {{"a", "mask"}}, {{"out", "other"}});
  auto input = b.input();
  input.bound.assign(b.graph.resources.size(), true);
  compiled(b, input);
  input.bound[b.resource("mask").value] = false;
  const Diagnostic error =
      rejected_once(b, input, DiagnosticId::unbound_import, "'apply_mask', port 'a' needs 'mask'");
  EXPECT_EQ(error.where.line,
            b.graph.place_of(b.read(static_cast<uint32_t>(b.graph.passes.size()) - 1, 0)).line);
}

TEST(Culling, AnOptionalPortOfAnUnboundImportStaysUnbound) {
  GraphBuilder b = chain();
  b.import("mask").optional = true;
  b.exported("other");
  b.pass("apply_mask", "test.shade", {{"a", "light"}, {"b", "mask"}}, {{"out", "other"}});
  auto input = b.input();
  input.bound.assign(b.graph.resources.size(), true);
  input.bound[b.resource("mask").value] = false;
  const auto plan = compiled(b, input);
  EXPECT_EQ(plan.plan.passes.back().access_count, 2u);
  EXPECT_THAT(reasons(b, plan, Reason::About::pass, b.pass_id("apply_mask").value),
              HasSubstr("optional port 'b' is unbound"));
}

TEST(Choice, DisabledPass_ReadersGetItsOtherwise) {
  GraphBuilder b{"import light", "image blurred", "export result"};
  b.boolean("on", true);
  auto& blur = b.pass("blur", "test.shade", {{"a", "light"}}, {{"out", "blurred"}});
  blur.when = b.when("on");
  b.otherwise(blur, "blurred", "light");
  b.pass("finish", "test.shade", {{"a", "blurred"}}, {{"out", "result"}});
  EXPECT_EQ(pass_names(b, compiled(b).plan), "blur finish");
  auto input = b.input();
  input.settings = {{SettingType::boolean, 0, 0.0}};
  const auto plan = compiled(b, input);
  EXPECT_EQ(pass_names(b, plan.plan), "finish");
  const PlanAccess& read = plan.plan.accesses[plan.plan.passes[0].first_access];
  EXPECT_EQ(plan.plan.resources[read.resource].declared, b.resource("light"));
  EXPECT_THAT(reasons(b, plan, Reason::About::pass, b.pass_id("blur").value), HasSubstr("off"));
}

TEST(Choice, OtherwiseIsAnUnboundImport_NamesBoth) {
  GraphBuilder b{"import light", "image blurred", "export result"};
  b.import("mask").optional = true;
  b.boolean("on", false);
  auto& blur = b.pass("blur", "test.shade", {{"a", "light"}}, {{"out", "blurred"}});
  blur.when = b.when("on");
  b.otherwise(blur, "blurred", "mask");
  b.pass("finish", "test.need", {{"a", "blurred"}}, {{"out", "result"}});
  auto input = b.input();
  input.bound.assign(b.graph.resources.size(), true);
  input.bound[b.resource("mask").value] = false;
  const Diagnostic error =
      rejected_once(b, input, DiagnosticId::unbound_import,
                    "needs 'blurred', whose producer is off, so that 'mask' replaces it, and "
                    "the host leaves 'mask' unbound");
  ASSERT_THAT(error.related, SizeIs(3));
  EXPECT_THAT(error.related[1].second, HasSubstr("'mask' is declared here"));
}

TEST(Choice, Otherwise_IsTheVersionThePassWouldHaveRead) {
  // 'light' is updated in place after the disabled pass, whose readers get the version before the
  // update.
  GraphBuilder b{"in_out light", "image blurred", "export result"};
  b.boolean("on", false);
  auto& blur = b.pass("blur", "test.shade", {{"a", "light"}}, {{"out", "blurred"}});
  blur.when = b.when("on");
  b.otherwise(blur, "blurred", "light");
  b.pass("brighten", "test.update", {}, {{"image", "light"}});
  b.pass("finish", "test.shade", {{"a", "blurred"}}, {{"out", "result"}});
  EXPECT_EQ(pass_names(b, compiled(b).plan), "finish brighten");
}

TEST(Choice, DisabledPassWithoutOtherwise_IsNamed) {
  GraphBuilder b{"import light", "image blurred", "export result"};
  b.boolean("on", false);
  b.pass("blur", "test.shade", {{"a", "light"}}, {{"out", "blurred"}}).when = b.when("on");
  b.pass("finish", "test.need", {{"a", "blurred"}}, {{"out", "result"}});
  const Diagnostic error =
      rejected_once(b, DiagnosticId::read_before_write, "pass 'finish', port 'a' reads 'blurred'");
  ASSERT_THAT(error.related, SizeIs(2));
  EXPECT_THAT(error.related[1].second, HasSubstr("'blur' writes it and is off"));
}

TEST(Choice, ExclusiveProducersOfOneResourceAreFine) {
  GraphBuilder b{"import light", "image scattered", "export result"};
  b.boolean("fast", false);
  b.pass("fast_way", "test.shade", {{"a", "light"}}, {{"out", "scattered"}}).when = b.when("fast");
  b.pass("slow_way", "test.shade", {{"a", "light"}}, {{"out", "scattered"}}).when =
      b.when("fast", false);
  b.pass("finish", "test.need", {{"a", "scattered"}}, {{"out", "result"}});
  EXPECT_EQ(pass_names(b, compiled(b).plan), "slow_way finish");
  auto input = b.input();
  input.settings = {{SettingType::boolean, 1, 0.0}};
  EXPECT_EQ(pass_names(b, compiled(b, input).plan), "fast_way finish");
}

TEST(Choice, TwoEnabledProducers_AreRejectedNamingBoth) {
  GraphBuilder b = chain();
  b.pass("blur_again", "test.shade", {{"a", "light"}}, {{"out", "blurred"}});
  const Diagnostic error = rejected_once(b, DiagnosticId::second_producer,
                                         "'blur' and 'blur_again' both write 'blurred'");
  EXPECT_EQ(error.related[0].first.line, b.graph.passes[0].where.line);
}

TEST(Choice, AReplacedResourceCannotBeUpdatedInPlace) {
  GraphBuilder b{"import light", "image blurred", "export result"};
  b.boolean("on", false);
  auto& blur = b.pass("blur", "test.shade", {{"a", "light"}}, {{"out", "blurred"}});
  blur.when = b.when("on");
  b.otherwise(blur, "blurred", "light");
  b.pass("sharpen", "test.update", {}, {{"image", "blurred"}});
  b.pass("finish", "test.need", {{"a", "blurred"}}, {{"out", "result"}});
  rejected_once(
      b, DiagnosticId::replaced_update,
      "'sharpen', port 'image' updates 'blurred' in place, but the producer of 'blurred' is off "
      "and 'light' replaces it");
}

TEST(Choice, AnOtherwiseOfAnotherTypeIsRejected) {
  GraphBuilder b = chain();
  b.boolean("on", false);
  b.buffer("tiles");
  auto& finish = b.graph.passes[1];
  finish.when = b.when("on");
  b.otherwise(finish, "result", "tiles");
  EXPECT_EQ(rejected(b)[0].id, DiagnosticId::otherwise_mismatch);
}

TEST(Choice, SettingsOutsideTheirRangeAreRejected) {
  GraphBuilder b = chain();
  auto& setting = b.boolean("samples", false);
  setting.type = SettingType::integer;
  setting.default_value = {SettingType::integer, 8, 0.0};
  setting.minimum = 1;
  setting.maximum = 64;
  compiled(b);
  auto input = b.input();
  input.settings = {{SettingType::integer, 65, 0.0}};
  EXPECT_EQ(rejected(b, input)[0].id, DiagnosticId::setting_value);
  input.settings = {{SettingType::real, 8, 8.0}};
  EXPECT_EQ(rejected(b, input)[0].id, DiagnosticId::setting_value);
}

TEST(Exports, ARequiredExportThatNothingWritesIsRejected) {
  GraphBuilder b = chain();
  b.boolean("on", false);
  b.graph.passes[1].when = b.when("on");
  const Diagnostic error = rejected_once(b, DiagnosticId::export_unwritten);
  EXPECT_THAT(error.related[0].second, HasSubstr("'finish' writes it and is off"));
}

// The `otherwise` of the last writer redirects readers; the export itself has the contents of the
// writer before.
TEST(Exports, OtherwiseOfTheLastWriter_KeepsEarlierContents) {
  GraphBuilder b = chain();
  b.boolean("on", false);
  b.exported("kept");
  b.pass("write", "test.shade", {{"a", "light"}}, {{"out", "kept"}});
  auto& update = b.pass("update", "test.update", {}, {{"image", "kept"}});
  update.when = b.when("on");
  b.otherwise(update, "kept", "light");
  EXPECT_EQ(pass_names(b, compiled(b).plan), "blur finish write");
}

TEST(Exports, ImportUpdatedInPlace_PassesOff_IsUnchanged) {
  GraphBuilder b;
  b.boolean("on", false);
  b.import("light").exported = true;
  b.pass("brighten", "test.update", {}, {{"image", "light"}}).when = b.when("on");
  const auto plan = compiled(b);
  EXPECT_THAT(plan.plan.passes, SizeIs(0));
  // The import is still released in the state that the host requests.
  ASSERT_EQ(plan.plan.final_barrier_count, 1u);
  EXPECT_TRUE(plan.plan.barriers[0].from_host && plan.plan.barriers[0].to_host);
}

TEST(Versions, ReaderSeesTheLatestEarlierVersion) {
  GraphBuilder b{"in_out light", "export before", "export after"};
  b.pass("copy_before", "test.need", {{"a", "light"}}, {{"out", "before"}});
  b.pass("brighten", "test.update", {}, {{"image", "light"}});
  b.pass("copy_after", "test.need", {{"a", "light"}}, {{"out", "after"}});
  EXPECT_EQ(pass_names(b, compiled(b).plan), "copy_before brighten copy_after");
}

// Each pass may write a part of the host's image (docs/format.md).
TEST(Versions, PassesMayWriteOneImportWithoutReading) {
  GraphBuilder b{"in_out light", "import mask"};
  b.pass("left", "test.need", {{"a", "mask"}}, {{"out", "light"}});
  b.pass("right", "test.need", {{"a", "mask"}}, {{"out", "light"}});
  EXPECT_EQ(pass_names(b, compiled(b).plan), "left right");
}

TEST(Versions, ReaderMayPrecedeTheOnlyProducer) {
  GraphBuilder b{"import light", "image blurred", "export result"};
  b.pass("finish", "test.need", {{"a", "blurred"}}, {{"out", "result"}});
  b.pass("blur", "test.need", {{"a", "light"}}, {{"out", "blurred"}});
  EXPECT_EQ(pass_names(b, compiled(b).plan), "blur finish");
}

TEST(Versions, AReaderBeforeSeveralProducersIsRejected) {
  GraphBuilder b{"import light", "image blurred", "export result"};
  b.pass("finish", "test.need", {{"a", "blurred"}}, {{"out", "result"}});
  b.pass("blur", "test.need", {{"a", "light"}}, {{"out", "blurred"}});
  b.pass("sharpen", "test.update", {}, {{"image", "blurred"}});
  EXPECT_EQ(rejected(b)[0].id, DiagnosticId::ambiguous_version);
}

TEST(Versions, UpdateOfUnwrittenResourceIsRejected) {
  GraphBuilder b = chain();
  b.image("sum");
  b.exported("total");
  b.pass("add", "test.update", {{"a", "light"}}, {{"image", "sum"}});
  b.pass("show", "test.need", {{"a", "sum"}}, {{"out", "total"}});
  rejected_once(b, DiagnosticId::read_before_write);
}

TEST(Versions, WritingTheSameResourceThroughTwoPortsIsRejected) {
  GraphBuilder b = chain();
  b.exported("twice");
  b.pass("double", "test.shade", {{"a", "light"}}, {{"out", "twice"}, {"out2", "twice"}});
  EXPECT_EQ(rejected(b)[0].id, DiagnosticId::second_producer);
}

// Adds passes of which two read from each other.
GraphBuilder cycle() {
  GraphBuilder b = chain();
  b.image("x");
  b.image("y");
  b.exported("z");
  b.pass("first", "test.need", {{"a", "y"}}, {{"out", "x"}});
  b.pass("second", "test.need", {{"a", "x"}}, {{"out", "y"}});
  b.pass("third", "test.need", {{"a", "y"}}, {{"out", "z"}});
  return b;
}

TEST(Order, CycleIsRejectedWithThePlaceOfEachPass) {
  const GraphBuilder b = cycle();
  const Diagnostic error =
      rejected_once(b, DiagnosticId::pass_cycle, "'first' -> 'second' -> 'first'");
  EXPECT_EQ(error.where.line, b.graph.passes[2].where.line);
  ASSERT_THAT(error.related, SizeIs(2));
  EXPECT_THAT(error.related[0].second, HasSubstr("'second' reads 'x' from 'first'"));
  EXPECT_EQ(error.related[0].first.line, b.graph.passes[3].where.line);
  EXPECT_THAT(error.related[1].second, HasSubstr("'first' reads 'y' from 'second'"));
}

// Errors that are no longer listed stop the compiler, too.
TEST(Order, CycleAfterTooManyDiagnostics_IsRejected) {
  const GraphBuilder b = cycle();
  Diagnostics diagnostics;
  diagnostics.add(DiagnosticId::syntax, {}, "an error of another graph");
  while (!diagnostics.full())
    diagnostics.add(DiagnosticId::option_unavailable, {}, "a note");
  EXPECT_FALSE(compile(b.input(), diagnostics));
  EXPECT_GT(diagnostics.dropped_errors, 0u);
  const GraphBuilder good = chain();
  EXPECT_TRUE(compile(good.input(), diagnostics)) << "errors of an earlier graph do not count";
}

TEST(Order, CycleAmongUnneededPassesIsRejected) {
  GraphBuilder b = chain();
  b.image("x");
  b.image("y");
  b.pass("first", "test.need", {{"a", "y"}}, {{"out", "x"}});
  b.pass("second", "test.need", {{"a", "x"}}, {{"out", "y"}});
  EXPECT_EQ(rejected(b)[0].id, DiagnosticId::pass_cycle);
}

TEST(Order, AfterIsObeyedAndTakesPartInCycles) {
  GraphBuilder b = chain();
  b.exported("other");
  b.pass("late", "test.need", {{"a", "light"}}, {{"out", "other"}});
  b.graph.passes[0].after.push_back({b.pass_id("late"), "to test it", {}});
  EXPECT_EQ(pass_names(b, compiled(b).plan), "late blur finish");
  b.graph.passes[2].after.push_back({b.pass_id("finish"), "to close the circle", {}});
  const auto errors = rejected(b);
  EXPECT_EQ(errors[0].id, DiagnosticId::pass_cycle);
  EXPECT_THAT(errors[0].related.back().second, HasSubstr("to test it"));
}

TEST(Order, AHistoryReadIsNoCycle) {
  GraphBuilder b{"import light", "history sum", "export result"};
  b.pass("accumulate", "test.shade", {{"a", "light"}, {"b", "sum@-1"}}, {{"out", "sum"}});
  b.pass("show", "test.need", {{"a", "sum"}}, {{"out", "result"}});
  EXPECT_EQ(pass_names(b, compiled(b).plan), "accumulate show");
}

TEST(History, ReadOfAHistoryWithoutWriterIsRejected) {
  GraphBuilder b{"import light", "history sum", "export result"};
  b.boolean("on", false);
  b.pass("accumulate", "test.need", {{"a", "light"}}, {{"out", "sum"}}).when = b.when("on");
  b.pass("show", "test.need", {{"a", "sum@-1"}}, {{"out", "result"}});
  rejected_once(b, DiagnosticId::history_unwritten, "reads 'sum@-1'");
}

TEST(History, PassReadOnlyInLaterFramesRuns) {
  GraphBuilder b{"import light", "history last", "export result"};
  b.pass("show", "test.shade", {{"a", "light"}, {"b", "last@-1"}}, {{"out", "result"}});
  b.pass("keep", "test.need", {{"a", "light"}}, {{"out", "last"}});
  EXPECT_EQ(pass_names(b, compiled(b).plan), "show keep");
}

TEST(History, ReadOnlyByItsWriter_KeepsNothingAlive) {
  GraphBuilder b = chain();
  b.history("sum");
  b.pass("accumulate", "test.shade", {{"a", "light"}, {"b", "sum@-1"}}, {{"out", "sum"}});
  EXPECT_EQ(pass_names(b, compiled(b).plan), "blur finish");
}

TEST(History, HostResourceCannotBeAHistory) {
  GraphBuilder b = chain();
  b.graph.resources[2].history.frames = 1;
  EXPECT_EQ(rejected(b)[0].id, DiagnosticId::history_of_host_memory);
}

} // namespace
} // namespace dermis::testing
