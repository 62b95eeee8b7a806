// Each change that breaks the passes of a good graph or their connections gives exactly one
// diagnostic.

#include "tests/framegraph/damaged_graph.hpp"
#include "tests/support/text_file.hpp"

namespace dermis {
namespace {

using namespace dermis::testing;
using Id = DiagnosticId;

class DamagedPass : public ::testing::TestWithParam<Damage> {};

TEST_P(DamagedPass, GivesOneDiagnosticAtTheDamage) {
  expect_one_diagnostic(GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    Passes, DamagedPass,
    ::testing::Values(
        damage("TheKindIsRegistered", R"("test.list")", R"("test.lst")", Id::unknown_pass_type,
               R"("test.ls)", {"pass 'find'", "did you mean 'test.list'?"}),
        damage("ABufferHoldsWhatAKernelReads", R"("count": "view/8")", R"("count": "view/16")",
               Id::resource_too_small, R"("list": {)",
               {"'tiles' of pass 'find'", "bytes for a view of 127x65", "'list' has"}),
        damage("PassNamesAreDistinct", R"("pass": "mix")", R"("pass": "blur")", Id::duplicate_name,
               R"("blur", "type": "test.m)", {"'blur'", "first declared here"}),
        damage("APassHasAName", R"("pass": "mix", )", "", Id::missing_key, R"({ "type")",
               {"pass number 4", "'pass'"}),
        damage("AMisspeltPassKeyIsTheOnlyError", R"("pass": "mix")", R"("pas": "mix")",
               Id::unknown_key, R"("pas":)", {"pass number 4", "did you mean 'pass'?"}),
        damage("AnUnknownPortHasASuggestion", R"("read": { "source": "light")",
               R"("read": { "sorce": "light")", Id::unknown_port, R"("sorce":)",
               {"pass 'blur'", "'test.blur'", "under \"read\"; it has", "did you mean 'source'?"}),
        damage("ARequiredPortIsBound",
               R"("read": { "source": "half" }, "write": { "target": "fixed" })",
               R"("write": { "target": "fixed" })", Id::missing_port, R"("copy", )",
               {"pass 'copy'", "'source'", "what to blur"}),
        damage("AWriterMissingItsPortIsTheOnlyError", R"("write": { "target": "half", )",
               R"("write": { )", Id::missing_port, R"("blur", )", {"'target'"}),
        damage("AMisspeltListOfPortsIsTheOnlyError", R"("write": { "target": "light" })",
               R"("wirte": { "target": "light" })", Id::unknown_key, R"("wirte")",
               {"did you mean 'write'?"}),
        damage("AReadingPortStandsUnderRead", R"("write": { "tiles": "list" })",
               R"("write": { "tiles": "list", "mask": "material" })", Id::port_direction,
               R"("mask": "material" } )", {"'mask'", "only reads", R"("read")"}),
        damage("AnUpdatingPortStandsUnderWrite", R"("write": { "target": "light" })",
               R"("write": {})", Id::missing_port, R"("mix", ")", {"'target'"}),
        damage("AnUnknownResourceHasASuggestion", R"("source": "light")", R"("source": "ligth")",
               Id::unknown_resource, R"("ligth",)",
               {"port 'source' of pass 'blur'", "did you mean 'light'?"}),
        damage("AMisspeltTargetIsTheOnlyError", R"("target": "half")", R"("target": "hallf")",
               Id::unknown_resource, R"("hallf",)", {"did you mean 'half'?"}),
        damage("ABufferIsNoImage", R"("source": "light")", R"("source": "list")",
               Id::usage_mismatch, R"("list", "m)",
               {"expects an image", "'list' is a buffer", "declared here"}),
        damage("AnImageIsNoBuffer", R"("tiles": "list", "history")",
               R"("tiles": "light", "history")", Id::usage_mismatch, R"("light", "h)",
               {"expects a buffer", "'light' is an image"}),
        damage("TheFormatSuitsThePort", R"("format": "rgba16f", "size": [64)",
               R"("format": "r8_unorm", "size": [64)", Id::format_mismatch, R"("fixed" )",
               {"'rgba16f' or 'rgba32f'", "'r8_unorm'", "'fixed' is declared here"}),
        damage("FormatsThatFitNoPortAreToldOnce", R"(["rgba16f", "rgba32f"])", R"("rgba32_uint")",
               Id::format_mismatch, R"("light", "m)",
               {"port 'source' of pass 'blur'", "'light' declares 'rgba32_uint'",
                "port 'target' of pass 'mix'"}),
        damage("IntegerTexturesHoldIntegers", R"("mask": "material", "tiles")",
               R"("mask": "light", "tiles")", Id::format_mismatch, R"("light", "t)",
               {"'r8_uint'", "'light' declares"}),
        damage("HistoryGoesAsFarBackAsDeclared", R"("kept@-2")", R"("kept@-3")", Id::history_range,
               R"("kept@-3)", {"'kept' keeps 2", "declared here"}),
        damage("ImportsHaveNoHistory", R"("kept@-2")", R"("light@-1")", Id::history_range,
               R"("light@-)", {"an import has no history"}),
        damage("EarlierFramesHaveNegativeNumbers", R"("kept@-2")", R"("kept@1")", Id::bad_reference,
               R"("kept@1")", {"'kept@1'"}),
        damage("EarlierFramesAreNotWritten", R"("history": "kept" })", R"("history": "kept@-1" })",
               Id::history_write, R"("kept@-1)", {"'kept@-1'"}),
        damage("AnUnknownSettingOfTheKindHasASuggestion", R"("set": { "samples")",
               R"("set": { "sample")", Id::unknown_pass_setting, R"("sample")",
               {"'test.blur'", "did you mean 'samples'?"}),
        damage("AKindWithoutSettingsSaysSo", R"("write": { "target": "light" })",
               R"("write": { "target": "light" }, "set": { "x": 1 })", Id::unknown_pass_setting,
               R"("x": 1 })", {"no settings"}),
        damage("AnUnknownSettingOfTheGraphHasASuggestion", R"("$samples")", R"("$sampels")",
               Id::unknown_setting, R"("$sampel)", {"'$sampels'", "did you mean 'samples'?"}),
        damage("ASettingHasTheTypeOfTheKinds", R"("$samples")", R"("$radius")",
               Id::setting_mismatch, R"("$radius",)",
               {"a real number", "an integer", "declared here"}),
        damage("ASettingStaysInTheRangeOfTheKinds", R"("max": 64)", R"("max": 65)",
               Id::setting_mismatch, R"("$sample)", {"4 .. 65", "1 .. 64"}),
        damage("ASettingHasTheOptionsOfTheKinds", R"("$quality")", R"("$style")",
               Id::setting_mismatch, R"("$style")", {"'fast', 'good' or 'best'"}),
        damage("ALiteralHasTheTypeOfTheKinds", R"("radius": 2)", R"("radius": "2")",
               Id::setting_literal, R"("2", "mo)", {"setting 'radius' of pass 'blur'"}),
        damage("ALiteralStaysInTheRangeOfTheKinds", R"("radius": 2)", R"("radius": 9)",
               Id::out_of_range, R"(9, "mode)", {"0 .. 8"}),
        damage("ALiteralIsAnOptionOfTheKinds", R"("mode": "best")", R"("mode": "bset")",
               Id::setting_literal, R"("bset", )", {"did you mean 'best'?"})),
    property_of);

INSTANTIATE_TEST_SUITE_P(
    ValidHistories, DamagedPass,
    ::testing::Values(
        damage("ThisFrameCannotBeInvalid", R"("history": "kept@-2")",
               R"("history": { "from": "kept", "requires": "valid" })", Id::bad_requires,
               R"("kept", "requires")",
               {"port 'history' of pass 'blur'", "'kept'", "of the current frame"}),
        damage("WhatStandsInForAHistoryIsNoHistory", R"("history": "kept@-2")",
               R"("history": { "from": "kept@-2", "requires": "valid", "otherwise": "kept@-1" })",
               Id::bad_requires, R"("kept@-1" })", {"port 'history' of pass 'blur'", "'kept@-2'"}),
        damage("OnlyValidityCanBeRequired", R"("history": "kept@-2")",
               R"("history": { "from": "kept@-2", "requires": "valld" })", Id::invalid_value,
               R"("valld")", {"'valid'"}),
        damage("ARequirementSaysOfWhat", R"("history": "kept@-2")",
               R"("history": { "requires": "valid" })", Id::missing_key, R"({ "requires")",
               {"'from'"}),
        damage("WhatStandsInFitsThePort", R"("history": "kept@-2")",
               R"("history": { "from": "kept@-2", "requires": "valid", "otherwise": "material" })",
               Id::format_mismatch, R"("material" } },)",
               {"port 'history' of pass 'blur'", "'material'"})),
    property_of);

INSTANTIATE_TEST_SUITE_P(Queues, DamagedPass,
                         ::testing::Values(damage("AQueueIsOneOfTwo", R"("pass": "mix", )",
                                                  R"("pass": "mix", "queue": "asink", )",
                                                  Id::invalid_value, R"("asink")",
                                                  {"'queue' of pass 'mix'", "'async'"})),
                         property_of);

TEST(Queue, DefaultIsMain) {
  const Read result =
      read(damaged("\"pass\": \"mix\", ", "\"pass\": \"mix\", \"queue\": \"async\", "));
  ASSERT_TRUE(result.graph) << all_messages(result.diagnostics);
  EXPECT_FALSE(result.graph->passes[2].async);
  EXPECT_TRUE(result.graph->passes[3].async);
}

INSTANTIATE_TEST_SUITE_P(
    Parts, DamagedPass,
    ::testing::Values(damage("ALayerThatTheImageHas",
                             R"("read": { "source": "half" }, "write": { "target": "fixed" })",
                             R"("read": { "source": "half#1[2]" }, "write": { "target": "fixed" })",
                             Id::bad_subresource, R"("half#1[2]")",
                             {"port 'source' of pass 'copy'", "'half#1[2]'", "2 layers"}),
                      damage("WhatTheHostBindsIsWhole", R"("read": { "source": "light")",
                             R"("read": { "source": "light#0")", Id::bad_subresource,
                             R"("light#0")", {"'light' is bound by the host"}),
                      damage("AMipThatTheHistoryHas", R"("history": "kept@-2")",
                             R"("history": "kept#1@-2")", Id::bad_subresource, R"("kept#1@-2")",
                             {"'kept' has 1 mip"}),
                      damage("BuffersHaveNoMips", R"("tiles": "list", "history")",
                             R"("tiles": "list#0", "history")", Id::bad_subresource, R"("list#0")",
                             {"'list' is a buffer"}),
                      damage("APortWritesOneMip", R"("target": "half")", R"("target": "half#0..1")",
                             Id::bad_subresource, R"("half#0..1")",
                             {"port 'target' of pass 'blur' writes one mip", "'half#0..1'"}),
                      damage("AllMipsAreSeveral", R"("target": "half")", R"("target": "half#0..")",
                             Id::bad_subresource, R"("half#0..")",
                             {"port 'target' of pass 'blur' writes one mip", "'half#0..'"}),
                      damage("AllMipsAreMipsToo", R"("tiles": "list", "history")",
                             R"("tiles": "list#0..", "history")", Id::bad_subresource,
                             R"("list#0..")", {"'list' is a buffer"}),
                      damage("PartsAreNumbers",
                             R"("read": { "source": "half" }, "write": { "target": "fixed" })",
                             R"("read": { "source": "half#x" }, "write": { "target": "fixed" })",
                             Id::bad_reference, R"("half#x")", {"'half#x'", "#1..3"})),
    property_of);

TEST(ValidHistory, RequiredPortNeedsAnOtherwise) {
  const std::string text = damaged(
      "\"source\": \"light\"", "\"source\": { \"from\": \"kept@-1\", \"requires\": \"valid\" }");
  EXPECT_TRUE(read(text).graph); // The read gives zeros: the history is cleared first.
  const Read result = read(test::replaced(text, "\"first\": \"clear\", ", ""));
  EXPECT_FALSE(result.graph);
  expect_only(result.diagnostics, Id::bad_requires, 21, 37,
              {"port 'source' of pass 'blur'", "'kept@-1'"});
}

TEST(ValidHistory, BecomesTwoBindingsOfOnePort) {
  const Read result = read(damaged("\"history\": \"kept@-2\"",
                                   "\"history\": { \"from\": \"kept@-2\", \"requires\": "
                                   "\"valid\", \"otherwise\": \"light\" }"));
  ASSERT_TRUE(result.graph) << all_messages(result.diagnostics);
  const auto reads = result.graph->reads(result.graph->passes[1]);
  ASSERT_EQ(reads.size(), 5u);
  EXPECT_EQ(reads[3].when, ReadWhen::history_valid);
  EXPECT_EQ(reads[3].frames_back, 2u);
  EXPECT_EQ(reads[4].when, ReadWhen::history_invalid);
  EXPECT_EQ(reads[4].port, reads[3].port);
  EXPECT_EQ(result.graph->resources[reads[4].resource.value].name, "light");
}

INSTANTIATE_TEST_SUITE_P(
    Relations, DamagedPass,
    ::testing::Values(
        damage("OtherwiseReplacesWhatThePassWrites", R"({ "half": "light" })",
               R"({ "fixed": "light" })", Id::bad_otherwise, R"("fixed": ")",
               {"'fixed', which it does not write"}),
        damage("OtherwiseReplacesByAnotherResource", R"({ "half": "light" })",
               R"({ "half": "half" })", Id::bad_otherwise, R"("half" } )", {"with itself"}),
        damage("OtherwiseReplacesByTheSameType", R"({ "half": "light" })", R"({ "half": "list" })",
               Id::bad_otherwise, "\"list\" } },\n    { \"pass\": \"c",
               {"one is an image and the other is a buffer"}),
        damage("OtherwiseNamesAResource", R"({ "half": "light" })", R"({ "half": "ligth" })",
               Id::unknown_resource, R"("ligth" )", {"did you mean 'light'?"}),
        damage("OtherwiseNeedsAWhen",
               R"("when": "quality in ['good', 'best'] and not mirror == false",)", "",
               Id::bad_otherwise, R"("otherwi)", {"no 'when'"}),
        damage("AfterNamesAPass", R"({ "pass": "find", "reason")", R"({ "pass": "fimd", "reason")",
               Id::unknown_pass, R"("fimd", )", {"did you mean 'find'?"}),
        damage("AfterNamesAnotherPass", R"({ "pass": "find", "reason")",
               R"({ "pass": "copy", "reason")", Id::unknown_pass, R"("copy", "r)",
               {"the pass itself"}),
        damage("AfterNeedsAReason", R"("keeps captures in order")", R"("")", Id::invalid_value,
               R"("" }] },)", {R"(empty "reason")"}),
        damage("AnExportHasAProducer", R"("target": "fixed")", R"("target": "kept")",
               Id::no_producer, R"("fixed":)", {"the graph exports 'fixed'", "no pass writes"}),
        damage("APassWritesAResourceThroughOnePort", R"("write": { "target": "fixed" })",
               R"("write": { "target": "fixed", "history": "fixed" })", Id::two_producers,
               "\"fixed\" },\n      \"set\"", {"'fixed' through two ports"})),
    property_of);

} // namespace
} // namespace dermis
