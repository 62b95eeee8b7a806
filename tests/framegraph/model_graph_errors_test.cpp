// Each change that breaks the declarations of a good graph gives exactly one diagnostic.

#include "tests/framegraph/damaged_graph.hpp"

namespace dermis {
namespace {

using namespace dermis::testing;
using Id = DiagnosticId;

class DamagedGraph : public ::testing::TestWithParam<Damage> {};

TEST_P(DamagedGraph, GivesOneDiagnosticAtTheDamage) {
  expect_one_diagnostic(GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    Root, DamagedGraph,
    ::testing::Values(damage("TheVersionIsRequired", R"("dermis": 2, )", "", Id::missing_key,
                             R"({ "$sche)", {R"("dermis": 2)"}),
                      damage("ANewerVersionIsRejected", R"("dermis": 2)", R"("dermis": 3)",
                             Id::unsupported_version, R"(3, "name)", {"version 2"}),
                      damage("AnUnknownKeyHasASuggestion", R"("imports": {)", R"("import": {)",
                             Id::unknown_key, R"("import")", {"did you mean 'imports'?"}),
                      damage("TheNameIsAName", R"("whole")", R"("a b")", Id::bad_name,
                             R"("a b", ")", {"'a b'"}),
                      damage("PassesAreAList", R"("exports": ["light", "fixed"])",
                             R"("exports": 7)", Id::wrong_type, "7 }", {"an array"}),
                      damage("OverlaysAreNotAcceptedYet", R"("note": "all of it")",
                             R"("overlays": [])", Id::unknown_key, R"("overlay)", {"'overlays'"})),
    property_of);

INSTANTIATE_TEST_SUITE_P(
    Settings, DamagedGraph,
    ::testing::Values(damage("ASettingNeedsAType", R"("bool": true)", R"("unit": "x")",
                             Id::missing_key, R"({ "unit")", {"setting 'mirror'", "'bool'"}),
                      damage("AMisspeltTypeHasASuggestion", R"("bool": true)", R"("bol": true)",
                             Id::unknown_key, R"("bol")",
                             {"setting 'mirror'", "did you mean 'bool'?"}),
                      damage("TheDefaultLiesInTheRange", R"("int": 16)", R"("int": 99)",
                             Id::setting_range, R"(99, "min)", {"99", "4 .. 64"}),
                      damage("TheDefaultIsNotBelowTheRange", R"("int": 16)", R"("int": 1)",
                             Id::setting_range, R"(1, "min)", {"the minimum is declared here"}),
                      damage("TheRangeIsNotEmpty", R"("max": 64)", R"("max": 3)", Id::setting_range,
                             R"(3, "unit)", {"setting 'samples' has the maximum 3"}),
                      damage("NumbersNeedARange", R"(, "max": 64)", "", Id::missing_key,
                             R"({ "int")", {"'max'", "setting 'samples'"}),
                      damage("TheDefaultIsAnOption", R"("default": "fancy")",
                             R"("default": "fncy")", Id::setting_range, R"("fncy" })",
                             {"did you mean 'fancy'?"}),
                      damage("OptionsAreDistinct", R"(["plain", "fancy"])", R"(["fancy", "fancy"])",
                             Id::duplicate_name, R"("fancy"])", {"'fancy'", "setting 'style'"}),
                      damage("WordsOfExpressionsAreReserved", R"("style": {)", R"("not": {)",
                             Id::bad_name, R"("not": {)", {"'not'"}),
                      damage("WhoChoosesIsListed", R"("budget")", R"("luck")", Id::invalid_value,
                             R"("luck")", {"'host' or 'budget'"}),
                      damage("AnErrorInASettingStaysAlone", R"("real": 1.5, "min": 0)",
                             R"("real": "much", "min": 0)", Id::wrong_type, R"("much", )",
                             {"'real' of setting 'radius'"})),
    property_of);

INSTANTIATE_TEST_SUITE_P(
    Resources, DamagedGraph,
    ::testing::Values(
        damage("AnUnknownFormatHasASuggestion", R"("r8_uint")", R"("r8uint")", Id::invalid_value,
               R"("r8uint")", {"did you mean 'r8_uint'?"}),
        damage("BuffersAreNotRescaled", R"("extra": 4 } })",
               R"("extra": 4 }, "history": { "frames": 1, "on_resize": "rescale" } })",
               Id::bad_history, R"("rescale" } } })", {"'list'", "only images"}),
        damage("FormatsAreNotEmpty", R"(["rgba16f", "rgba32f"])", "[]", Id::out_of_range,
               R"([], "siz)", {"'format' of import 'light'"}),
        damage("ImportsHaveNoMips", "\"optional\": true },\n    \"material\"",
               "\"mips\": 2 },\n    \"material\"", Id::unknown_key, R"("mips": 2)",
               {"import 'depth'", "'mips'"}),
        damage("AFactorIsAPositiveInteger", R"("view*3/4")", R"("view*3/0")", Id::bad_size,
               R"(0", "rou)", {"after '/'"}),
        damage("ASizeNamesAnImageThatExists", R"("half/2")", R"("halv/2")", Id::unknown_resource,
               R"("halv/2")",
               {"'halv', which is neither \"view\", \"square_view\" nor declared",
                "did you mean 'half'?"}),
        damage("ASizeIsNotItsOwnBase", R"("half/2")", R"("kept/2")", Id::bad_size, R"(kept/2",)",
               {"itself"}),
        damage("ASizeIsNotThatOfABuffer", R"("half/2")", R"("list/2")", Id::bad_size, R"("list/2")",
               {"'list' is a buffer"}),
        damage("AFixedSizeHasTwoNumbers", "[64, 32]", "[64]", Id::wrong_type, R"([64], "o)",
               {"'size' of resource 'fixed'"}),
        damage("ASideIsAtLeastOne", "[64, 32]", "[0, 32]", Id::out_of_range, "0, 32], ",
               {"the width", "1 .. 16384"}),
        damage("ABorderIsBounded", R"("border": 1)", R"("border": 65)", Id::out_of_range,
               R"(65, "mips)", {"0 .. 64"}),
        damage("HistoryIsBounded", R"("frames": 2)", R"("frames": 9)", Id::out_of_range,
               R"(9, "firs)", {"1 .. 8", "the history of resource 'kept'"}),
        damage("AStrideIsInWords", R"("stride": 4)", R"("stride": 6)", Id::out_of_range,
               R"(6, "coun)", {"multiple of 4"}),
        damage("NoResourceIsCalledView", R"("depth": {)", R"("view": {)", Id::bad_name,
               R"("view": )", {"'view'"}),
        damage("OptionalNeedsAnExport", R"(, "fixed"] })", "] }", Id::bad_export,
               "true },\n    \"list", {"resource 'fixed'"}),
        damage("BuffersAreNotExported", R"(["light", "fixed"])", R"(["light", "fixed", "list"])",
               Id::bad_export, R"("list"] )", {"'list' is a buffer"}),
        damage("ExportsHaveOneMip", "[64, 32], ", R"([64, 32], "mips": 2, )", Id::bad_export,
               R"(2, "optional")", {"'fixed'", "several mips"}),
        damage("ExportsHaveOneLayer", "[64, 32], ", R"([64, 32], "layers": 3, )", Id::bad_export,
               R"(3, "optional")", {"'fixed'", "several layers"}),
        damage("AnExportIsListedOnce", R"(["light", "fixed"])", R"(["light", "fixed", "light"])",
               Id::duplicate_name, R"("light"])", {"'light' is exported twice"}),
        damage("AnExportIsDeclared", R"(["light", "fixed"])", R"(["light", "fixd"])",
               Id::unknown_resource, R"("fixd"] )", {"did you mean 'fixed'?"}),
        damage("ANameIsDeclaredOnce", R"("depth": { "format")", R"("half": { "format")",
               Id::duplicate_name, R"("half": { "format": "r)", {"'half'", "first declared here"})),
    property_of);

} // namespace
} // namespace dermis
