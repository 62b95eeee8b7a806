// Each damage to a good graph gives exactly one diagnostic, at the place of the damage, naming both sides.

#include "tests/framegraph/model_support.hpp"

#include "framegraph/text/limits.hpp"

#include <algorithm>

namespace dermis {
namespace {

using namespace dermis::testing;

struct Damage {
  const char* law; // also the name of the test
  const char *from, *to;
  DiagnosticId id;
  const char* at; // the damaged text has this once, and the diagnostic points at its beginning
  std::vector<std::string> words;
};

void PrintTo(const Damage& damage, std::ostream* out) {
  *out << damage.to;
}

std::string law_of(const ::testing::TestParamInfo<Damage>& one) {
  return one.param.law;
}

class DamagedGraph : public ::testing::TestWithParam<Damage> {};

TEST_P(DamagedGraph, GivesOneDiagnosticAtTheDamage) {
  const Damage& damage = GetParam();
  const std::string text = damaged(damage.from, damage.to);
  const size_t at = text.find(damage.at);
  ASSERT_NE(at, std::string::npos);
  ASSERT_EQ(text.find(damage.at, at + 1), std::string::npos) << "ambiguous";
  const std::string before = text.substr(0, at);
  const auto line = static_cast<uint32_t>(1 + std::count(before.begin(), before.end(), '\n'));
  const auto column =
      static_cast<uint32_t>(at - (before.rfind('\n') + 1) + 1); // npos + 1 = 0 on the first line
  const Read result = read(text);
  EXPECT_FALSE(result.graph);
  expect_only(result.diagnostics, damage.id, line, column, damage.words);
}

using Id = DiagnosticId;

INSTANTIATE_TEST_SUITE_P(
    Root, DamagedGraph,
    ::testing::Values(
        Damage{
            "TheVersionIsRequired", "\"dermis\": 1, ", "", Id::missing_key, "{ \"$sche", {"\"dermis\": 1"}},
        Damage{"ANewerVersionIsRefused",
               "\"dermis\": 1",
               "\"dermis\": 2",
               Id::unsupported_version,
               "2, \"name",
               {"version 1"}},
        Damage{"AnUnknownKeyHasASuggestion",
               "\"imports\": {",
               "\"import\": {",
               Id::unknown_key,
               "\"import\"",
               {"did you mean 'imports'?"}},
        Damage{"TheNameIsAName", "\"whole\"", "\"a b\"", Id::bad_name, "\"a b\", \"", {"'a b'"}},
        Damage{"PassesAreAList",
               "\"exports\": [\"light\", \"fixed\"]",
               "\"exports\": 7",
               Id::wrong_type,
               "7 }",
               {"an array"}},
        Damage{"OverlaysAreNotAcceptedYet",
               "\"note\": \"all of it\"",
               "\"overlays\": []",
               Id::unknown_key,
               "\"overlay",
               {"'overlays'"}}),
    law_of);

INSTANTIATE_TEST_SUITE_P(Settings, DamagedGraph,
                         ::testing::Values(Damage{"ASettingNeedsAType",
                                                  "\"bool\": true",
                                                  "\"unit\": \"x\"",
                                                  Id::missing_key,
                                                  "{ \"unit\"",
                                                  {"setting 'mirror'", "'bool'"}},
                                           Damage{"AMisspeltTypeHasASuggestion",
                                                  "\"bool\": true",
                                                  "\"bol\": true",
                                                  Id::unknown_key,
                                                  "\"bol\"",
                                                  {"setting 'mirror'", "did you mean 'bool'?"}},
                                           Damage{"TheDefaultLiesInTheRange",
                                                  "\"int\": 16",
                                                  "\"int\": 99",
                                                  Id::setting_range,
                                                  "99, \"min",
                                                  {"99", "4 .. 64"}},
                                           Damage{"TheRangeIsNotEmpty",
                                                  "\"max\": 64",
                                                  "\"max\": 3",
                                                  Id::setting_range,
                                                  "3, \"unit",
                                                  {"setting 'samples' ends at 3"}},
                                           Damage{"NumbersNeedARange",
                                                  ", \"max\": 64",
                                                  "",
                                                  Id::missing_key,
                                                  "{ \"int\"",
                                                  {"'max'", "setting 'samples'"}},
                                           Damage{"TheDefaultIsAnOption",
                                                  "\"default\": \"fancy\"",
                                                  "\"default\": \"fncy\"",
                                                  Id::setting_range,
                                                  "\"fncy\" }",
                                                  {"did you mean 'fancy'?"}},
                                           Damage{"OptionsAreDistinct",
                                                  "[\"plain\", \"fancy\"]",
                                                  "[\"fancy\", \"fancy\"]",
                                                  Id::duplicate_name,
                                                  "\"fancy\"]",
                                                  {"'fancy'", "setting 'style'"}},
                                           Damage{"WordsOfExpressionsAreReserved",
                                                  "\"style\": {",
                                                  "\"not\": {",
                                                  Id::bad_name,
                                                  "\"not\": {",
                                                  {"'not'"}},
                                           Damage{"WhoChoosesIsListed",
                                                  "\"budget\"",
                                                  "\"luck\"",
                                                  Id::invalid_value,
                                                  "\"luck\"",
                                                  {"'host' or 'budget'"}},
                                           Damage{"AnErrorInASettingStaysAlone",
                                                  "\"real\": 1.5, \"min\": 0",
                                                  "\"real\": \"much\", \"min\": 0",
                                                  Id::wrong_type,
                                                  "\"much\", ",
                                                  {"'real' of setting 'radius'"}}),
                         law_of);

INSTANTIATE_TEST_SUITE_P(
    Resources, DamagedGraph,
    ::testing::Values(
        Damage{"AnUnknownFormatHasASuggestion",
               "\"r8_uint\"",
               "\"r8uint\"",
               Id::invalid_value,
               "\"r8uint\"",
               {"did you mean 'r8_uint'?"}},
        Damage{"BuffersAreNotRescaled",
               "\"extra\": 4 } }",
               "\"extra\": 4 }, \"history\": { \"frames\": 1, \"on_resize\": \"rescale\" } }",
               Id::bad_history,
               "\"rescale\" } } }",
               {"'list'", "only images"}},
        Damage{"FormatsAreNotEmpty",
               "[\"rgba16f\", \"rgba32f\"]",
               "[]",
               Id::out_of_range,
               "[], \"siz",
               {"'format' of import 'light'"}},
        Damage{"ImportsHaveNoMips",
               "\"optional\": true },\n    \"material\"",
               "\"mips\": 2 },\n    \"material\"",
               Id::unknown_key,
               "\"mips\": 2",
               {"import 'depth'", "'mips'"}},
        Damage{"AFactorIsAPositiveInteger",
               "\"view*3/4\"",
               "\"view*3/0\"",
               Id::bad_size,
               "0\", \"rou",
               {"behind '/'"}},
        Damage{"ASizeNamesAnImageThatExists",
               "\"half/2\"",
               "\"halv/2\"",
               Id::unknown_resource,
               "\"halv/2\"",
               {"'halv'", "did you mean 'half'?"}},
        Damage{"ASizeIsNotItsOwnBase", "\"half/2\"", "\"kept/2\"", Id::bad_size, "kept/2\",", {"itself"}},
        Damage{"ASizeIsNotThatOfABuffer",
               "\"half/2\"",
               "\"list/2\"",
               Id::bad_size,
               "\"list/2\"",
               {"'list' is a buffer"}},
        Damage{"AFixedSizeHasTwoNumbers",
               "[64, 32]",
               "[64]",
               Id::wrong_type,
               "[64], \"o",
               {"'size' of resource 'fixed'"}},
        Damage{"ASideIsAtLeastOne",
               "[64, 32]",
               "[0, 32]",
               Id::out_of_range,
               "0, 32], ",
               {"the width", "1 .. 16384"}},
        Damage{"ABorderIsBounded",
               "\"border\": 1",
               "\"border\": 65",
               Id::out_of_range,
               "65, \"mips",
               {"0 .. 64"}},
        Damage{"HistoryIsBounded",
               "\"frames\": 2",
               "\"frames\": 9",
               Id::out_of_range,
               "9, \"firs",
               {"1 .. 8", "the history of resource 'kept'"}},
        Damage{"AStrideIsInWords",
               "\"stride\": 4",
               "\"stride\": 6",
               Id::out_of_range,
               "6, \"coun",
               {"multiple of 4"}},
        Damage{
            "NoResourceIsCalledView", "\"depth\": {", "\"view\": {", Id::bad_name, "\"view\": ", {"'view'"}},
        Damage{"OptionalNeedsAnExport",
               ", \"fixed\"] }",
               "] }",
               Id::bad_export,
               "true },\n    \"list",
               {"resource 'fixed'"}},
        Damage{"BuffersAreNotExported",
               "[\"light\", \"fixed\"]",
               "[\"light\", \"fixed\", \"list\"]",
               Id::bad_export,
               "\"list\"] ",
               {"'list' is a buffer"}},
        Damage{"AnExportIsListedOnce",
               "[\"light\", \"fixed\"]",
               "[\"light\", \"fixed\", \"light\"]",
               Id::duplicate_name,
               "\"light\"]",
               {"'light' is exported twice"}},
        Damage{"AnExportIsDeclared",
               "[\"light\", \"fixed\"]",
               "[\"light\", \"fixd\"]",
               Id::unknown_resource,
               "\"fixd\"] ",
               {"did you mean 'fixed'?"}},
        Damage{"ANameIsDeclaredOnce",
               "\"depth\": { \"format\"",
               "\"half\": { \"format\"",
               Id::duplicate_name,
               "\"half\": { \"format\": \"r",
               {"'half'", "first declared here"}}),
    law_of);

INSTANTIATE_TEST_SUITE_P(
    Passes, DamagedGraph,
    ::testing::Values(Damage{"TheKindIsRegistered",
                             "\"test.list\"",
                             "\"test.lst\"",
                             Id::unknown_kind,
                             "\"test.ls",
                             {"pass 'find'", "did you mean 'test.list'?"}},
                      Damage{"PassNamesAreDistinct",
                             "\"pass\": \"mix\"",
                             "\"pass\": \"blur\"",
                             Id::duplicate_name,
                             "\"blur\", \"kind\": \"test.m",
                             {"'blur'", "first declared here"}},
                      Damage{"APassHasAName",
                             "\"pass\": \"mix\", ",
                             "",
                             Id::missing_key,
                             "{ \"kind\"",
                             {"pass number 4", "'pass'"}},
                      Damage{"AMisspeltPassKeyIsTheOnlyError",
                             "\"pass\": \"mix\"",
                             "\"pas\": \"mix\"",
                             Id::unknown_key,
                             "\"pas\":",
                             {"pass number 4", "did you mean 'pass'?"}},
                      Damage{"AnUnknownPortHasASuggestion",
                             "\"read\": { \"source\": \"light\"",
                             "\"read\": { \"sorce\": \"light\"",
                             Id::unknown_port,
                             "\"sorce\":",
                             {"pass 'blur'", "'test.blur'", "did you mean 'source'?"}},
                      Damage{"ARequiredPortIsBound",
                             "\"read\": { \"source\": \"half\" }, \"write\": { \"target\": \"fixed\" }",
                             "\"write\": { \"target\": \"fixed\" }",
                             Id::missing_port,
                             "\"copy\", ",
                             {"pass 'copy'", "'source'", "what to blur"}},
                      Damage{"AWriterMissingItsPortIsTheOnlyError",
                             "\"write\": { \"target\": \"half\", ",
                             "\"write\": { ",
                             Id::missing_port,
                             "\"blur\", ",
                             {"'target'"}},
                      Damage{"AReadingPortStandsUnderRead",
                             "\"write\": { \"tiles\": \"list\" }",
                             "\"write\": { \"tiles\": \"list\", \"mask\": \"material\" }",
                             Id::port_direction,
                             "\"mask\": \"material\" } ",
                             {"'mask'", "only reads", "\"read\""}},
                      Damage{"AnUpdatingPortStandsUnderWrite",
                             "\"write\": { \"target\": \"light\" }",
                             "\"write\": {}",
                             Id::missing_port,
                             "\"mix\", \"",
                             {"'target'"}},
                      Damage{"AnUnknownResourceHasASuggestion",
                             "\"source\": \"light\"",
                             "\"source\": \"ligth\"",
                             Id::unknown_resource,
                             "\"ligth\",",
                             {"port 'source' of pass 'blur'", "did you mean 'light'?"}},
                      Damage{"AMisspeltTargetIsTheOnlyError",
                             "\"target\": \"half\"",
                             "\"target\": \"hallf\"",
                             Id::unknown_resource,
                             "\"hallf\",",
                             {"did you mean 'half'?"}},
                      Damage{"ABufferIsNoImage",
                             "\"source\": \"light\"",
                             "\"source\": \"list\"",
                             Id::usage_mismatch,
                             "\"list\", \"m",
                             {"takes an image", "'list' is a buffer", "declared here"}},
                      Damage{"AnImageIsNoBuffer",
                             "\"tiles\": \"list\", \"history\"",
                             "\"tiles\": \"light\", \"history\"",
                             Id::usage_mismatch,
                             "\"light\", \"h",
                             {"takes a buffer", "'light' is an image"}},
                      Damage{"TheFormatSuitsThePort",
                             "\"format\": \"rgba16f\", \"size\": [64",
                             "\"format\": \"r8_unorm\", \"size\": [64",
                             Id::format_mismatch,
                             "\"fixed\" ",
                             {"'rgba16f' or 'rgba32f'", "'r8_unorm'", "'fixed' is declared here"}},
                      Damage{"FormatsThatFitNoPortAreToldOnce",
                             "[\"rgba16f\", \"rgba32f\"]",
                             "\"rgba32_uint\"",
                             Id::format_mismatch,
                             "\"light\", \"m",
                             {"port 'source' of pass 'blur'", "'light' declares 'rgba32_uint'",
                              "port 'target' of pass 'mix'"}},
                      Damage{"IntegerTexturesHoldIntegers",
                             "\"mask\": \"material\", \"tiles\"",
                             "\"mask\": \"light\", \"tiles\"",
                             Id::format_mismatch,
                             "\"light\", \"t",
                             {"'r8_uint'", "'light' declares"}},
                      Damage{"HistoryGoesAsFarBackAsDeclared",
                             "\"kept@-2\"",
                             "\"kept@-3\"",
                             Id::history_range,
                             "\"kept@-3",
                             {"'kept' keeps 2", "declared here"}},
                      Damage{"ImportsHaveNoHistory",
                             "\"kept@-2\"",
                             "\"light@-1\"",
                             Id::history_range,
                             "\"light@-",
                             {"an import has no history"}},
                      Damage{"EarlierFramesHaveNegativeNumbers",
                             "\"kept@-2\"",
                             "\"kept@1\"",
                             Id::bad_reference,
                             "\"kept@1\"",
                             {"'kept@1'"}},
                      Damage{"EarlierFramesAreNotWritten",
                             "\"history\": \"kept\" }",
                             "\"history\": \"kept@-1\" }",
                             Id::history_write,
                             "\"kept@-1",
                             {"'kept@-1'"}},
                      Damage{"AnUnknownSettingOfTheKindHasASuggestion",
                             "\"set\": { \"samples\"",
                             "\"set\": { \"sample\"",
                             Id::unknown_kind_setting,
                             "\"sample\"",
                             {"'test.blur'", "did you mean 'samples'?"}},
                      Damage{"AKindWithoutSettingsSaysSo",
                             "\"write\": { \"target\": \"light\" }",
                             "\"write\": { \"target\": \"light\" }, \"set\": { \"x\": 1 }",
                             Id::unknown_kind_setting,
                             "\"x\": 1 }",
                             {"no settings"}},
                      Damage{"AnUnknownSettingOfTheGraphHasASuggestion",
                             "\"$samples\"",
                             "\"$sampels\"",
                             Id::unknown_setting,
                             "\"$sampel",
                             {"'$sampels'", "did you mean 'samples'?"}},
                      Damage{"ASettingHasTheTypeOfTheKinds",
                             "\"$samples\"",
                             "\"$radius\"",
                             Id::setting_mismatch,
                             "\"$radius\",",
                             {"a real number", "an integer", "declared here"}},
                      Damage{"ASettingStaysInTheRangeOfTheKinds",
                             "\"max\": 64",
                             "\"max\": 65",
                             Id::setting_mismatch,
                             "\"$sample",
                             {"4 .. 65", "1 .. 64"}},
                      Damage{"ASettingHasTheOptionsOfTheKinds",
                             "\"$quality\"",
                             "\"$style\"",
                             Id::setting_mismatch,
                             "\"$style\"",
                             {"'fast', 'good' or 'best'"}},
                      Damage{"ALiteralHasTheTypeOfTheKinds",
                             "\"radius\": 2",
                             "\"radius\": \"2\"",
                             Id::setting_literal,
                             "\"2\", \"mo",
                             {"setting 'radius' of pass 'blur'"}},
                      Damage{"ALiteralStaysInTheRangeOfTheKinds",
                             "\"radius\": 2",
                             "\"radius\": 9",
                             Id::out_of_range,
                             "9, \"mode",
                             {"0 .. 8"}},
                      Damage{"ALiteralIsAnOptionOfTheKinds",
                             "\"mode\": \"best\"",
                             "\"mode\": \"bset\"",
                             Id::setting_literal,
                             "\"bset\", ",
                             {"did you mean 'best'?"}}),
    law_of);

INSTANTIATE_TEST_SUITE_P(
    Relations, DamagedGraph,
    ::testing::Values(Damage{"OtherwiseReplacesWhatThePassWrites",
                             "{ \"half\": \"light\" }",
                             "{ \"fixed\": \"light\" }",
                             Id::bad_otherwise,
                             "\"fixed\": \"",
                             {"'fixed', which it does not write"}},
                      Damage{"OtherwiseReplacesByAnotherResource",
                             "{ \"half\": \"light\" }",
                             "{ \"half\": \"half\" }",
                             Id::bad_otherwise,
                             "\"half\" } ",
                             {"by itself"}},
                      Damage{"OtherwiseReplacesByTheSameType",
                             "{ \"half\": \"light\" }",
                             "{ \"half\": \"list\" }",
                             Id::bad_otherwise,
                             "\"list\" } },\n    { \"pass\": \"c",
                             {"one is an image, the other a buffer"}},
                      Damage{"OtherwiseNamesAResource",
                             "{ \"half\": \"light\" }",
                             "{ \"half\": \"ligth\" }",
                             Id::unknown_resource,
                             "\"ligth\" ",
                             {"did you mean 'light'?"}},
                      Damage{"OtherwiseNeedsAWhen",
                             "\"when\": \"quality in ['good', 'best'] and not mirror == false\",",
                             "",
                             Id::bad_otherwise,
                             "\"otherwi",
                             {"no 'when'"}},
                      Damage{"AfterNamesAPass",
                             "{ \"pass\": \"find\", \"reason\"",
                             "{ \"pass\": \"fimd\", \"reason\"",
                             Id::unknown_pass,
                             "\"fimd\", ",
                             {"did you mean 'find'?"}},
                      Damage{"AfterNamesAnotherPass",
                             "{ \"pass\": \"find\", \"reason\"",
                             "{ \"pass\": \"copy\", \"reason\"",
                             Id::unknown_pass,
                             "\"copy\", \"r",
                             {"the pass itself"}},
                      Damage{"AfterNeedsAReason",
                             "\"keeps captures in order\"",
                             "\"\"",
                             Id::invalid_value,
                             "\"\" }] },",
                             {"no reason"}},
                      Damage{"AnExportHasAProducer",
                             "\"target\": \"fixed\"",
                             "\"target\": \"kept\"",
                             Id::no_producer,
                             "\"fixed\":",
                             {"the graph exports 'fixed'", "no pass writes"}},
                      Damage{"APassWritesAResourceThroughOnePort",
                             "\"write\": { \"target\": \"fixed\" }",
                             "\"write\": { \"target\": \"fixed\", \"history\": \"fixed\" }",
                             Id::two_producers,
                             "\"fixed\" },\n      \"set\"",
                             {"'fixed' through two ports"}}),
    law_of);

std::string small_graph(const std::string& passes) {
  return R"({ "dermis": 1, "name": "g", "imports": { "a": { "format": "rgba16f", "size": "view" } },
"resources": { "x": { "format": "rgba16f", "size": "view" } }, "exports": ["a"], "passes": [)" +
         passes + "] }";
}

TEST(GraphErrors, TwoPassesThatAlwaysRunDoNotWriteTheSameResource) {
  const Read result = read(small_graph(R"(
{ "pass": "one", "kind": "test.blur", "read": { "source": "a" }, "write": { "target": "x" } },
{ "pass": "two", "kind": "test.blur", "read": { "source": "a" }, "write": { "target": "x" } })"));
  EXPECT_FALSE(result.graph);
  expect_only(result.diagnostics, Id::two_producers, 4, 87,
              {"'one' and 'two'", "'x'", "'one' writes it here"});
}

TEST(GraphErrors, WhatPassesOnlyUpdateHasNoContents) {
  const Read result = read(small_graph(R"(
{ "pass": "one", "kind": "test.mix", "read": { "source": "a" }, "write": { "target": "x" } })"));
  EXPECT_FALSE(result.graph);
  expect_only(result.diagnostics, Id::no_producer, 3, 86, {"pass 'one' updates 'x'", "only update"});
}

TEST(GraphErrors, WhatNoPassWritesCannotBeRead) {
  const Read result = read(small_graph(R"(
{ "pass": "one", "kind": "test.mix", "read": { "source": "x" }, "write": { "target": "a" } },
{ "pass": "two", "kind": "test.mix", "read": { "source": "x" }, "write": { "target": "a" } })"));
  EXPECT_FALSE(result.graph);
  expect_only(result.diagnostics, Id::no_producer, 3, 58, {"pass 'one' reads 'x'", "declared here"});
}

TEST(GraphErrors, AllRootCausesAreReportedInOneRunAndTheirConsequencesAreNot) {
  std::string text = damaged("\"r8_uint\"", "\"r8uint\""); // readers of material stay silent
  const auto also = [&](std::string_view from, std::string_view to) {
    ASSERT_NE(text.find(from), std::string::npos);
    text.replace(text.find(from), from.size(), to);
  };
  also("\"int\": 16", "\"int\": 1.5");                         // "$samples" stays silent
  also("\"kind\": \"test.list\"", "\"kind\": \"test.lisst\""); // the reader of list stays silent
  also("\"kept@-2\"", "\"keptt@-2\"");
  const Read result = read(text);
  EXPECT_FALSE(result.graph);
  ASSERT_EQ(result.diagnostics.list.size(), 4u) << all_messages(result.diagnostics);
  EXPECT_EQ(result.diagnostics.list[0].id, Id::wrong_type);
  EXPECT_EQ(result.diagnostics.list[1].id, Id::invalid_value);
  EXPECT_EQ(result.diagnostics.list[2].id, Id::unknown_kind);
  EXPECT_EQ(result.diagnostics.list[3].id, Id::unknown_resource);
}

TEST(GraphErrors, SectionsOfTheWrongTypeSilenceWhatReferredToThem) {
  for (const char* section : {"settings", "imports", "resources", "passes"}) {
    std::string text = whole_graph();
    const std::string key = std::string("  \"") + section + "\": ";
    const size_t at = text.find(key) + key.size();
    text.insert(at, "7, \"note_moved\": ");
    const Read result = read(text);
    EXPECT_FALSE(result.graph);
    ASSERT_EQ(result.diagnostics.list.size(), 2u) << section << "\n" << all_messages(result.diagnostics);
    EXPECT_EQ(result.diagnostics.list[0].id, Id::wrong_type);
    EXPECT_EQ(result.diagnostics.list[1].id, Id::unknown_key);
  }
}

TEST(GraphErrors, CountsBeyondTheLimitsAreRefused) {
  std::string many_passes, many_resources, many_settings;
  for (size_t i = 0; i <= limits::passes; ++i)
    many_passes += (i ? ",{}" : "{}");
  for (size_t i = 0; i <= limits::resources; ++i)
    many_resources += (i ? ",\"r" : "\"r") + std::to_string(i) + "\":{}";
  for (size_t i = 0; i <= limits::settings; ++i)
    many_settings += (i ? ",\"s" : "\"s") + std::to_string(i) + "\":{}";
  const std::string start = "{ \"dermis\": 1, \"name\": \"g\", ";
  expect_only(read(start + "\"exports\": [],\n\"passes\": [" + many_passes + "] }").diagnostics,
              Id::limit_exceeded, 2, 11, {"4097", "4096"});
  const std::string rest = "\"exports\": [], \"passes\": [],\n";
  expect_only(read(start + rest + "\"resources\": {" + many_resources + "} }").diagnostics,
              Id::limit_exceeded, 2, 14, {"4096"});
  expect_only(read(start + rest + "\"settings\": {" + many_settings + "} }").diagnostics, Id::limit_exceeded,
              2, 13, {"256"});
}

} // namespace
} // namespace dermis
