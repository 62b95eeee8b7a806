// Checks which resources a pass may both read and write, for every state of the settings.

#include "framegraph/compile/compile.hpp"
#include "framegraph/model/read_graph.hpp"
#include "framegraph/verify/verify.hpp"
#include "tests/framegraph/text_support.hpp"

#include <fmt/format.h>

namespace dermis::testing {
namespace {

constexpr Port blur_ports[] = {{"a", Usage::sampled_image, true, "texture2D", ""},
                               {"own", Usage::sampled_image, true, "texture2D", "", {}, true},
                               {"o", Usage::storage_image_write, false, "image2D", ""}};
constexpr Port update_ports[] = {{"a", Usage::sampled_image, true, "texture2D", ""},
                                 {"o", Usage::storage_image_update, false, "image2D", ""}};
constexpr Port list_ports[] = {{"in", Usage::storage_buffer_read, true, "uint", ""},
                               {"own", Usage::storage_buffer_read, true, "uint", "", {}, true},
                               {"out", Usage::storage_buffer_write, false, "uint", ""}};
constexpr Port ids_ports[] = {{"ids", Usage::sampled_image, false, "utexture2D", ""},
                              {"o", Usage::storage_image_write, false, "image2D", ""}};
constexpr Port clear_ports[] = {{"target", Usage::clear, false, "", ""}};

const PassTypeRegistry& pass_types() {
  static const PassTypeRegistry registry = [] {
    PassTypeRegistry out;
    out.add({"t.blur", "", "", blur_ports, {}});
    out.add({"t.update", "", "", update_ports, {}});
    out.add({"t.list", "", "", list_ports, {}});
    out.add({"t.ids", "", "", ids_ports, {}});
    out.add({"t.clear", "", "", clear_ports, {}});
    PassType scatter{"t.scatter", "", "", blur_ports, {}};
    scatter.serves_scattering = true;
    out.add(scatter);
    return out;
  }();
  return registry;
}

struct Case {
  const char* name;
  const char* passes;
  std::vector<std::string> words = {}; // Words of the message; empty if the graph is accepted.
  DiagnosticId id = DiagnosticId::in_place_race;
};

void PrintTo(const Case& one, std::ostream* out) {
  *out << one.name;
}

struct Outcome {
  Diagnostics diagnostics;
  std::optional<Graph> graph;
};

Outcome read_passes(const char* passes) {
  Outcome out;
  const std::string text = fmt::format(R"({{ "dermis": 2, "name": "g",
  "settings": {{ "sharp": {{ "bool": true }}, "soft": {{ "bool": false }},
    "mode": {{ "enum": ["off", "low", "high"], "default": "high" }},
    "n": {{ "int": 16, "min": 0, "max": 64 }}, "r": {{ "real": 1.5, "min": 0, "max": 8 }} }},
  "imports": {{ "light": {{ "format": "rgba16f", "size": "view" }},
    "ids": {{ "format": "r8_uint", "size": "view" }}, "mask": {{ "format": "r8_unorm", "size": "view" }} }},
  "resources": {{ "x": {{ "format": "rgba16f", "size": "view" }}, "y": {{ "format": "rgba16f", "size": "view" }},
    "id": {{ "format": "r8_uint", "size": "view" }},
    "h": {{ "format": "rgba16f", "size": "view", "history": {{ "frames": 1 }} }},
    "m": {{ "format": "rgba16f", "size": "view", "mips": 3, "layers": 2 }},
    "list": {{ "buffer": {{ "stride": 4, "count": "view/8" }} }},
    "out": {{ "format": "rgba16f", "size": "view" }} }},
  "passes": [ {} ],
  "exports": ["light", "out"] }})",
                                       passes);
  const auto document = parse_document("graph.json", text, out.diagnostics);
  if (document) out.graph = read_graph(*document, pass_types(), out.diagnostics);
  return out;
}

// The last pass, which only writes the export.
#define SHOW(resource)                                                                             \
  R"({ "pass": "show", "type": "t.blur", "read": { "a": ")" resource                               \
  R"(" }, "write": { "o": "out" } })"
#define X_FROM_LIGHT(when)                                                                         \
  R"({ "pass": "make", "type": "t.blur", "when": ")" when                                          \
  R"(", "read": { "a": "light" }, "write": { "o": "x" }, "otherwise": { "x": "light" } }, )"
#define BLUR_X(rest)                                                                               \
  R"({ "pass": "blur", "type": "t.blur", "read": { "a": "x" }, "write": { "o": "light" })" rest    \
  R"( }, )"

const Case rejected_cases[] = {
    {"Directly",
     R"({ "pass": "blur", "type": "t.blur", "read": { "a": "light" }, "write": { "o": "light" } }, )" SHOW(
         "light"),
     {"pass 'blur' reads 'light' through its port 'a'", "writes 'light' through 'o'"}},
    {"ThroughAnUpdate",
     R"({ "pass": "add", "type": "t.update", "read": { "a": "light" }, "write": { "o": "light" } }, )" SHOW(
         "light"),
     {"pass 'add'"}},
    {"OfABuffer",
     R"({ "pass": "fill", "type": "t.list", "write": { "out": "list" } },
        { "pass": "sort", "type": "t.list", "read": { "in": "list" }, "write": { "out": "list" } }, )" SHOW(
         "light"),
     {"pass 'sort' reads 'list' through its port 'in'"}},
    {"OfAMip",
     R"({ "pass": "clear", "type": "t.clear", "write": { "target": "m" } },
        { "pass": "down", "type": "t.blur", "read": { "a": "m#0..1" }, "write": { "o": "m#1" } }, )" SHOW(
         "m#1[0]"),
     {"reads 'm#0..1' through its port 'a' and writes 'm#1'"}},
    {"OfALayer",
     R"({ "pass": "clear", "type": "t.clear", "write": { "target": "m" } },
        { "pass": "down", "type": "t.blur", "read": { "a": "m[1]" }, "write": { "o": "m#2[0..1]" } }, )" SHOW(
         "m#1[0]"),
     {"'m[1]'"}},
    {"WhereAPassIsOff",
     X_FROM_LIGHT("sharp") BLUR_X("") SHOW("light"),
     {"pass 'blur' reads 'x', which 'light' replaces, through its port 'a' and writes 'light'"}},
    {"WhereTwoPassesAreOff",
     X_FROM_LIGHT("sharp") R"({ "pass": "more", "type": "t.blur", "when": "soft", "read": { "a": "x" },
        "write": { "o": "y" }, "otherwise": { "y": "x" } },
        { "pass": "blur", "type": "t.blur", "read": { "a": "y" }, "write": { "o": "light" } }, )" SHOW(
         "light"),
     {"reads 'y', which 'light' replaces,"}},
    {"WhereALaterPassIsOff",
     BLUR_X("") X_FROM_LIGHT("sharp") SHOW("light"),
     {"reads 'x', which 'light' replaces,"}},
    {"WhereAHistoryIsNotValid",
     R"({ "pass": "keep", "type": "t.blur", "read": { "a": { "from": "h@-1", "requires": "valid", "otherwise": "light" } },
          "write": { "o": "light" } },
        { "pass": "more", "type": "t.blur", "read": { "a": "light" }, "write": { "o": "h" } }, )" SHOW(
         "light"),
     {"reads 'light' through its port 'a'"}},
    {"WhereNothingScatters",
     R"({ "pass": "make", "type": "t.scatter", "read": { "a": "light" }, "write": { "o": "x" },
          "otherwise": { "x": "light" } }, )" BLUR_X("") SHOW("light"),
     {"pass 'blur' reads 'x', which 'light' replaces, through its port 'a' and writes 'light'"}},
    {"UnderConditionsThatMeet",
     X_FROM_LIGHT("n > 8 or r < 2") BLUR_X(R"(, "when": "n <= 8 and r > 1.9")") SHOW("light"),
     {"pass 'blur'"}},
    {"UnderOptionsThatMeet",
     X_FROM_LIGHT("mode in ['low']") BLUR_X(R"(, "when": "mode != 'low' and mode != 'off'")")
         SHOW("light"),
     {"pass 'blur'"}},
    {"AStandInOfAnotherComponentType",
     R"({ "pass": "clear", "type": "t.clear", "when": "sharp", "write": { "target": "id" }, "otherwise": { "id": "mask" } },
        { "pass": "use", "type": "t.ids", "read": { "ids": "id" }, "write": { "o": "out" } })",
     {"port 'ids' of pass 'use' reads the replacement of 'id' and supports 'r8_uint'",
      "'mask' declares 'r8_unorm'"},
     DiagnosticId::format_mismatch},
};

const Case accepted_cases[] = {
    {"ItsOwnTexels",
     R"({ "pass": "blur", "type": "t.blur", "read": { "own": "light" }, "write": { "o": "light" } }, )" SHOW(
         "light")},
    {"ItsOwnElements",
     R"({ "pass": "fill", "type": "t.list", "write": { "out": "list" } },
        { "pass": "sort", "type": "t.list", "read": { "own": "list" }, "write": { "out": "list" } }, )" SHOW(
         "light")},
    {"ItsOwnTexelsWhereAPassIsOff",
     X_FROM_LIGHT("sharp") R"({ "pass": "blur", "type": "t.blur", "read": { "own": "x" }, "write": { "o": "light" } }, )" SHOW(
         "light")},
    {"AnUpdateOfItsOwn",
     R"({ "pass": "add", "type": "t.update", "read": { "a": "mask" }, "write": { "o": "light" } }, )" SHOW(
         "light")},
    {"AnotherMip",
     R"({ "pass": "base", "type": "t.blur", "read": { "a": "light" }, "write": { "o": "m#0" } },
        { "pass": "down", "type": "t.blur", "read": { "a": "m#0" }, "write": { "o": "m#1" } }, )" SHOW(
         "m#1[0]")},
    {"AnotherLayer",
     R"({ "pass": "base", "type": "t.blur", "read": { "a": "light" }, "write": { "o": "m#0[0]" } },
        { "pass": "copy", "type": "t.blur", "read": { "a": "m#0[0]" }, "write": { "o": "m#0[1]" } }, )" SHOW(
         "m#0[1]")},
    {"AnotherFrame",
     R"({ "pass": "keep", "type": "t.blur", "read": { "a": "h@-1" }, "write": { "o": "h" } }, )" SHOW(
         "h")},
    {"UnderEqualConditions", X_FROM_LIGHT("sharp") BLUR_X(R"(, "when": "sharp")") SHOW("light")},
    {"WhereNothingScatters_AndTheReaderIsOff",
     R"({ "pass": "make", "type": "t.scatter", "read": { "a": "light" }, "write": { "o": "x" },
          "otherwise": { "x": "light" } },
        { "pass": "more", "type": "t.scatter", "read": { "a": "x" }, "write": { "o": "light" } }, )" SHOW(
         "light")},
    {"UnderNumbersThatExcludeEachOther",
     X_FROM_LIGHT("n > 4 or r <= 2.5") BLUR_X(R"(, "when": "n >= 5 and r > 2.5 or n == 5")")
         SHOW("light")},
    {"UnderOptionsThatExcludeEachOther",
     X_FROM_LIGHT("mode != 'off'") BLUR_X(R"(, "when": "mode in ['low', 'high'] and not sharp")")
         SHOW("light")},
    {"WhereAnotherPassWritesIt",
     X_FROM_LIGHT(
         "sharp") R"({ "pass": "plain", "type": "t.blur", "when": "not sharp", "read": { "a": "light" },
        "write": { "o": "x" } }, )" BLUR_X("") SHOW("light")},
};

struct InPlace : ::testing::TestWithParam<Case> {};

TEST_P(InPlace, EveryStateOfTheSettingsIsChecked) {
  const Case& one = GetParam();
  const Outcome result = read_passes(one.passes);
  if (one.words.empty()) {
    ASSERT_TRUE(result.graph) << all_messages(result.diagnostics);
    const DeviceProfile device = generic_profile();
    CompileInput input;
    input.graph = &*result.graph;
    input.pass_types = &pass_types();
    input.device = &device;
    input.view_width = input.view_height = 64;
    Diagnostics diagnostics;
    const auto plan = compile(input, diagnostics);
    ASSERT_TRUE(plan) << all_messages(diagnostics);
    EXPECT_TRUE(verify(plan->plan).proven());
    return;
  }
  EXPECT_FALSE(result.graph);
  ASSERT_EQ(result.diagnostics.list.size(), 1u) << all_messages(result.diagnostics);
  EXPECT_EQ(result.diagnostics.list[0].id, one.id);
  for (const std::string& word : one.words)
    EXPECT_THAT(result.diagnostics.list[0].text, HasSubstr(word));
}

std::string name_of(const ::testing::TestParamInfo<Case>& one) {
  return one.param.name;
}

INSTANTIATE_TEST_SUITE_P(Rejected, InPlace, ::testing::ValuesIn(rejected_cases), name_of);
INSTANTIATE_TEST_SUITE_P(Accepted, InPlace, ::testing::ValuesIn(accepted_cases), name_of);

// The last pass reads a chain of replacements that ends at what it writes. Whether that can happen
// depends on 1000 conditions with as many numbers.
TEST(InPlaceLimit, LongChainsOfConditionsAreRejected) {
  std::string resources, passes;
  for (int i = 0; i < 1000; ++i) {
    resources += fmt::format(R"("x{}": {{ "format": "rgba16f", "size": "view" }}, )", i);
    passes += fmt::format(R"({{ "pass": "p{0}", "type": "t.blur", "when": "n == 3 or r > {2}",
      "read": {{ "a": "{1}" }}, "write": {{ "o": "x{0}" }}, "otherwise": {{ "x{0}": "{1}" }} }}, )",
                          i, i == 0 ? "light" : fmt::format("x{}", i - 1), i * 0.004);
  }
  const std::string text = fmt::format(R"({{ "dermis": 2, "name": "g",
  "settings": {{ "n": {{ "int": 16, "min": 0, "max": 64 }}, "r": {{ "real": 1.5, "min": 0, "max": 8 }} }},
  "imports": {{ "light": {{ "format": "rgba16f", "size": "view" }} }},
  "resources": {{ {} "out": {{ "format": "rgba16f", "size": "view" }} }},
  "passes": [ {} {{ "pass": "last", "type": "t.blur", "when": "n > 8 and r > 5",
    "read": {{ "a": "x999" }}, "write": {{ "o": "light" }} }}, {} ],
  "exports": ["light", "out"] }})",
                                       resources, passes, SHOW("light"));
  Diagnostics diagnostics;
  const auto document = parse_document("graph.json", text, diagnostics);
  ASSERT_TRUE(document) << all_messages(diagnostics);
  EXPECT_FALSE(read_graph(*document, pass_types(), diagnostics));
  ASSERT_EQ(diagnostics.list.size(), 1u) << all_messages(diagnostics);
  EXPECT_EQ(diagnostics.list[0].id, DiagnosticId::limit_exceeded);
  EXPECT_THAT(diagnostics.list[0].text, HasSubstr("port 'a' of pass 'last'"));
}

// The order of the operands of a condition does not matter, even if the settings with most values
// come first.
TEST(InPlace, ConditionsOfManySettings_AreDecided) {
  Diagnostics diagnostics;
  const auto document = parse_document("graph.json", R"({ "dermis": 2, "name": "g",
  "settings": { "q": { "enum": ["low", "mid", "high"], "default": "high" },
    "r1": { "real": 1, "min": 0, "max": 8 }, "r2": { "real": 1, "min": 0, "max": 8 },
    "r3": { "real": 1, "min": 0, "max": 8 } },
  "imports": { "light": { "format": "rgba16f", "size": "view" } },
  "resources": { "x": { "format": "rgba16f", "size": "view" } },
  "passes": [
    { "pass": "make", "type": "t.blur", "when": "q == 'high'", "read": { "a": "light" },
      "write": { "o": "x" }, "otherwise": { "x": "light" } },
    { "pass": "blur", "type": "t.blur", "when": "r1 > 0 and r2 > 0 and r3 > 0 and q == 'high'",
      "read": { "a": "x" }, "write": { "o": "light" } } ],
  "exports": ["light"] })",
                                       diagnostics);
  ASSERT_TRUE(document);
  EXPECT_TRUE(read_graph(*document, pass_types(), diagnostics)) << all_messages(diagnostics);
}

} // namespace
} // namespace dermis::testing
