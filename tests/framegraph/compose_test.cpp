// Tests graphs composed of fragments and overlays, and that every message points into the file that
// set the value.

#include "framegraph/compose/compose.hpp"
#include "framegraph/text/limits.hpp"
#include "tests/framegraph/model_support.hpp"
#include "tests/support/text_file.hpp"

#include <fmt/format.h>

#include <map>

namespace dermis {
namespace {

using namespace dermis::testing;
using Id = DiagnosticId;

using Files = std::map<std::string, std::string, std::less<>>;

struct Composed {
  Diagnostics diagnostics;
  std::optional<Composition> composition;
  std::optional<Graph> graph;
};

Composed put_together(const std::string& graph, const std::vector<std::string>& overlays,
                      const Files& files = {}) {
  Composed out;
  std::vector<Document> read;
  auto document = parse_document("graph.json", graph, out.diagnostics);
  for (size_t i = 0; i < overlays.size(); ++i)
    if (auto overlay =
            parse_document(fmt::format("overlay{}.json", i), overlays[i], out.diagnostics))
      read.push_back(std::move(*overlay));
  EXPECT_TRUE(document && read.size() == overlays.size()) << all_messages(out.diagnostics);
  const OpenFile open = [&](std::string_view name) {
    const auto found = files.find(name);
    return found == files.end() ? FileText{"", "", "it is not there"}
                                : FileText{std::string(name), found->second, ""};
  };
  out.composition = compose(std::move(*document), std::move(read), open, out.diagnostics);
  if (!out.composition) return out;
  out.graph = read_graph(out.composition->document, pass_types(), out.diagnostics);
  relate_to_removals(out.composition->changes, 0, out.diagnostics);
  return out;
}

std::string overlay(const std::string& edits) {
  return "{ \"dermis_overlay\": 2, \"edits\": [\n" + edits + " ] }";
}

// Returns the whole graph after these edits.
Composed edited(const std::string& edits) {
  return put_together(whole_graph(), {overlay(edits)});
}

std::vector<std::string> pass_names(const Composed& composed) {
  std::vector<std::string> out;
  if (!composed.graph)
    ADD_FAILURE() << all_messages(composed.diagnostics);
  else
    for (const PassDeclaration& pass : composed.graph->passes)
      out.push_back(pass.name);
  return out;
}

std::string file_of(const Composed& composed, const SourceLocation& where) {
  return composed.diagnostics.files[where.file.value].name;
}

// Expects exactly one message with this id, file and text.
void expect_one(const Composed& composed, Id id, const std::string& place,
                const std::vector<std::string>& words) {
  EXPECT_FALSE(composed.graph);
  ASSERT_EQ(composed.diagnostics.list.size(), 1u) << all_messages(composed.diagnostics);
  const Diagnostic& one = composed.diagnostics.list[0];
  EXPECT_EQ(diagnostic_info(one.id).name, diagnostic_info(id).name);
  const std::string whole = format_for_people(composed.diagnostics, one);
  EXPECT_EQ(whole.rfind(place, 0), 0u) << whole;
  for (const std::string& word : words)
    EXPECT_NE(whole.find(word), std::string::npos) << word << "\n" << whole;
}

constexpr const char* copy_pass =
    R"({ "pass": "again", "type": "test.blur", "read": { "source": "half" }, "write": { "target": "fixed" } })";

TEST(Compose, AGraphWithoutIncludesAndOverlaysIsLeftAsItIs) {
  const Composed composed = put_together(whole_graph(), {});
  ASSERT_TRUE(composed.composition);
  EXPECT_TRUE(composed.composition->document.sources.empty());
  EXPECT_TRUE(composed.graph);
}

TEST(Overlay, PassesAreInsertedReplacedAndRemovedByName) {
  const std::string fresh =
      R"({ "pass": "fresh", "type": "test.list", "read": { "mask": "material" }, )"
      R"("write": { "tiles": "list" } })";
  EXPECT_EQ(pass_names(edited(R"({ "remove": "/passes/copy" },
      { "set": "/resources/fixed", "to": { "format": "rgba16f", "size": "view" } },
      { "remove": "/exports/fixed" })")),
            (std::vector<std::string>{"find", "blur", "mix"}));
  EXPECT_EQ(
      pass_names(edited(fmt::format(R"({{ "replace": "copy", "passes": [{}] }})", copy_pass))),
      (std::vector<std::string>{"find", "blur", "again", "mix"}));
  const std::string without_find =
      R"({ "remove": "/passes/copy/after" }, { "remove": "/passes/find" },)";
  EXPECT_EQ(
      pass_names(edited(without_find +
                        fmt::format(R"({{ "insert_before": "blur", "passes": [{}] }})", fresh))),
      (std::vector<std::string>{"fresh", "blur", "copy", "mix"}));
  EXPECT_EQ(
      pass_names(edited(without_find +
                        fmt::format(R"({{ "insert_after": "mix", "passes": [{}] }})", fresh))),
      (std::vector<std::string>{"blur", "copy", "mix", "fresh"}));
}

TEST(Overlay, StackInOrderAndTheLastOneWins) {
  const std::string first = overlay(R"({ "set": "/settings/samples/int", "to": 20 },
    { "set": "/settings/extra", "to": { "bool": true } })");
  const std::string second = overlay(R"({ "set": "/settings/samples/int", "to": 30 })");
  const Composed composed = put_together(whole_graph(), {first, second});
  ASSERT_TRUE(composed.graph) << all_messages(composed.diagnostics);
  EXPECT_EQ(composed.graph->settings[1].default_value.integer, 30);
  EXPECT_EQ(composed.graph->settings.back().name, "extra");
  EXPECT_EQ(file_of(composed, composed.graph->settings.back().where), "overlay0.json");
  EXPECT_EQ(file_of(composed, composed.graph->settings[1].where), "graph.json");
  const std::vector<Change>& changes = composed.composition->changes;
  ASSERT_EQ(changes.size(), 3u);
  EXPECT_EQ(changes[0].at, "/settings/samples/int");
  EXPECT_EQ(change_name(changes[0].what), "set");
  EXPECT_EQ(file_of(composed, changes[2].where), "overlay1.json");
  EXPECT_EQ(put_together(whole_graph(), {second, first}).graph->settings[1].default_value.integer,
            20);
}

TEST(Overlay, ArrayElements_ByNameIndexOrDash) {
  const Composed composed = edited(R"({ "set": "/imports/light/format/rgba32f", "to": "r32f" },
    { "set": "/resources/fixed/size/1", "to": 48 }, { "set": "/settings/style/enum/-", "to": "odd" },
    { "set": "/passes/blur/set/radius", "to": 3 })");
  ASSERT_TRUE(composed.graph) << all_messages(composed.diagnostics);
  EXPECT_EQ(composed.graph->resources[0].formats, (FormatList{Format::rgba16f, Format::r32f}));
  EXPECT_EQ(composed.graph->resources[5].size.y.numerator, 48);
  EXPECT_EQ(composed.graph->settings[4].options.size(), 3u);
  EXPECT_EQ(composed.graph->passes[1].settings.size(), 4u);
}

TEST(Overlay, WrongValueIsReportedInTheFileThatSetIt) {
  expect_one(edited(R"({ "set": "/settings/samples/int", "to": 99 })"), Id::setting_range,
             "overlay0.json:2:41", {"99", "graph.json:4:", "the maximum is declared here"});
  expect_one(edited(R"({ "set": "/passes/blur/when", "to": "samples > qality" })"),
             Id::unknown_setting, "overlay0.json:2:48", {"'qality'"});
  expect_one(edited(R"({ "set": "/resources/halff", "to": { "format": "r32f" } })"),
             Id::missing_key, "overlay0.json:2:36", {"'halff'"});
}

TEST(Overlay, EditOfAMissingTarget_IsRejected) {
  expect_one(edited(R"({ "remove": "/passes/blurr" })"), Id::edit_target, "overlay0.json:2:13",
             {"'remove' of edit 1", "'blurr'", "did you mean 'blur'?"});
  expect_one(edited(R"({ "set": "/resource/half/mips", "to": 1 })"), Id::edit_target,
             "overlay0.json:2:10", {"'resource'", "did you mean 'resources'?"});
  expect_one(edited(R"({ "set": "name", "to": "x" })"), Id::edit_target, "overlay0.json:2:10",
             {"a path must begin with '/'"});
  expect_one(edited(R"({ "set": "/exports/7", "to": "x" })"), Id::edit_target, "overlay0.json:2:10",
             {"'7'"});
  expect_one(edited(R"({ "set": "/name/of", "to": "x" })"), Id::edit_target, "overlay0.json:2:10",
             {"'of'"});
  expect_one(edited(fmt::format(R"({{ "insert_after": "mixx", "passes": [{}] }})", copy_pass)),
             Id::edit_target, "overlay0.json:2:19", {"did you mean 'mix'?"});
}

TEST(Overlay, CanAddTheFirstSettingAndPassMembers) {
  const std::string graph = R"({ "dermis": 2, "name": "plain",
  "resources": { "a": { "format": "rgba16f", "size": "view" } },
  "passes": [ { "pass": "copy", "type": "test.blur", "read": { "source": "light" }, "write": { "target": "a" } } ] })";
  const Composed composed = put_together(
      graph, {overlay(R"({ "set": "/settings/wide", "to": { "real": 3, "min": 0, "max": 8 } },
                         { "set": "/imports/light", "to": { "format": "rgba16f", "size": "view" } },
                         { "set": "/exports/-", "to": "a" },
                         { "set": "/passes/copy/set/radius", "to": "$wide" })")});
  ASSERT_TRUE(composed.graph) << all_messages(composed.diagnostics);
  ASSERT_EQ(composed.graph->settings.size(), 1u);
  EXPECT_EQ(composed.graph->settings[0].name, "wide");
  ASSERT_EQ(composed.graph->passes.size(), 1u);
}

TEST(Overlay, EditOfARemovedTarget_NamesTheRemover) {
  const Composed composed =
      put_together(whole_graph(), {overlay(R"({ "remove": "/passes/copy" })"),
                                   overlay(R"({ "set": "/passes/copy/set/radius", "to": 1 })")});
  expect_one(
      composed, Id::edit_target, "overlay1.json:2:10",
      {"'copy' does not exist when", "overlay0.json:2:13", "'/passes/copy' is removed here"});
}

TEST(Overlay, ErrorsNameTheEditThatRemovedWhatIsMissing) {
  using Texts = std::vector<std::string>;
  const auto related = [](const Composed& composed) {
    EXPECT_FALSE(composed.graph);
    Texts out;
    for (const Diagnostic& one : composed.diagnostics.list)
      for (const auto& [where, text] : one.related)
        if (file_of(composed, where).starts_with("overlay"))
          out.push_back(fmt::format("{}: {}", file_of(composed, where), text));
    return out;
  };
  const auto contains = [&](const std::string& edits, const char* text) {
    const Texts all = related(edited(edits));
    return std::find(all.begin(), all.end(), text) != all.end();
  };
  EXPECT_TRUE(contains(R"({ "remove": "/resources/half" })",
                       "overlay0.json: '/resources/half' is removed here"));
  EXPECT_TRUE(contains(R"({ "remove": "/passes/blur/write/target" })",
                       "overlay0.json: '/passes/blur/write/target' is removed here"));
  for (const char* section : {"/imports", "/resources", "/passes", "/exports"}) {
    const std::string text = fmt::format("overlay0.json: '{}' is removed here", section);
    EXPECT_TRUE(contains(fmt::format(R"({{ "remove": "{}" }})", section), text.c_str())) << section;
  }
  EXPECT_TRUE(contains(R"({ "remove": "/resources/list/buffer" })",
                       "overlay0.json: '/resources/list/buffer' is removed here"));
  const std::string remove_find =
      R"({ "remove": "/passes/copy/after" }, { "remove": "/passes/find" })";
  EXPECT_EQ(related(edited(remove_find)),
            (Texts{"overlay0.json: no pass writes 'list' after this edit"}));
  // Another pass writes it again.
  const Composed restored = put_together(
      whole_graph(), {overlay(remove_find), overlay(R"({ "insert_before": "blur", "passes": [
        { "pass": "find", "type": "test.list", "write": { "tiles": "list" } }] })")});
  EXPECT_EQ(related(restored), Texts{}) << all_messages(restored.diagnostics);
}

TEST(Overlay, ErrorsNameTheSetEditThatCausedThem) {
  const auto contains = [](const Composed& composed, const char* text) {
    EXPECT_FALSE(composed.graph);
    const std::string all = all_messages(composed.diagnostics);
    return all.find(text) != std::string::npos;
  };
  const struct {
    const char *edit, *text;
  } cases[] = {
      // The error is located at the pass type.
      {R"({ "set": "/passes/mix/read", "to": {} })",
       "overlay0.json:2:10: '/passes/mix/read' is set here"},
      {R"({ "set": "/passes/find/type", "to": "test.blur" })", "'/passes/find/type' is set here"},
      {R"({ "set": "/resources/half/format", "to": "r8_uint" })",
       "'/resources/half/format' is set here"},
      {R"({ "set": "/settings/quality/choice", "to": ["fast", "good", "fine"] })",
       "'/settings/quality/choice' is set here"},
      {R"({ "set": "/settings", "to": {} })", "'/settings' is set here"},
  };
  for (const auto& [edit, text] : cases)
    EXPECT_TRUE(contains(edited(edit), text)) << edit << all_messages(edited(edit).diagnostics);
  // Not an edit that the error's place shows, one that a later edit replaced, or an unrelated one.
  const std::string wrong = R"({ "set": "/resources/half/format", "to": "r8_uint" })";
  EXPECT_FALSE(contains(edited(R"({ "set": "/resources/half/size", "to": "vieww" })"), "set here"));
  EXPECT_FALSE(
      contains(edited(R"({ "set": "/resources/half/mips", "to": 1 }, { "set": "/resources/half",
      "to": { "format": "r8_uint", "size": "view" } })"),
               "'/resources/half/mips' is set here"));
  EXPECT_FALSE(contains(edited(wrong + R"(, { "set": "/passes/copy/set/radius", "to": 1 })"),
                        "'/passes/copy/set/radius' is set here"));
}

TEST(Overlay, EachOverlayErrorIsReportedOnce) {
  expect_one(put_together(whole_graph(), {"{ \"dermis_overlay\": 3, \"edits\": [] }"}),
             Id::unsupported_version, "overlay0.json:1:21", {});
  expect_one(put_together(whole_graph(), {"{ \"dermis_overlay\": 2, \"edit\": [] }"}),
             Id::unknown_key, "overlay0.json:1:24", {"did you mean 'edits'?"});
  expect_one(edited("{ \"sett\": \"/name\", \"to\": 1 }"), Id::unknown_key, "overlay0.json:2:3",
             {"did you mean 'set'?"});
  expect_one(edited("{ \"note\": \"n\" }"), Id::missing_key, "overlay0.json:2:1",
             {"'insert_before'"});
  expect_one(edited("{ \"remove\": \"/name\", \"to\": 1 }"), Id::unknown_key, "overlay0.json:2:22",
             {"'to'"});
  expect_one(edited("{ \"replace\": \"mix\", \"passes\": [1] }"), Id::wrong_type,
             "overlay0.json:2:32", {"a pass of edit 1"});
}

TEST(Overlay, NestingBuiltByEditsStaysWithinTheLimit) {
  std::string deep = "1", edits, path = "/x";
  for (int i = 0; i < 40; ++i)
    deep = "{ \"a\": " + deep + " }";
  edits = fmt::format(R"({{ "set": "/x", "to": {} }},)", deep);
  for (int i = 0; i < 39; ++i)
    path += "/a";
  edits += fmt::format("\n{{ \"set\": \"{}\", \"to\": {} }}", path, deep);
  expect_one(edited(edits), Id::limit_exceeded, "overlay0.json:3:10", {"64 deep"});
}

constexpr const char* tiles_fragment = R"({ "dermis_fragment": 2, "note": "finds tiles",
  "imports": { "material": { "size": "view", "format": "r8_uint", "note": "the same in other words" } },
  "resources": { "list": { "buffer": { "stride": 4, "count": "view/8", "extra": 4 } } },
  "passes": [ { "pass": "find", "type": "test.list", "read": { "mask": "material" }, "write": { "tiles": "list" } } ] })";

// Returns whole_graph with its first pass and its buffer moved into a fragment.
std::string including_graph(const std::string& include = R"({ "include": "parts/tiles.json" })") {
  return test::replaced(
      damaged(",\n    \"list\": { \"buffer\": { \"stride\": 4, \"count\": \"view/8\", \"extra\": 4 "
              "} } }",
              " }"),
      R"({ "pass": "find", "type": "test.list", "read": { "mask": "material" }, "write": { "tiles": "list" } })",
      include);
}

TEST(Include, FragmentPassesAreInsertedAtTheInclude) {
  const Composed composed =
      put_together(including_graph(), {}, {{"parts/tiles.json", tiles_fragment}});
  EXPECT_EQ(pass_names(composed), (std::vector<std::string>{"find", "blur", "copy", "mix"}));
  EXPECT_EQ(composed.graph->resources.back().name, "list");
  EXPECT_EQ(file_of(composed, composed.graph->passes[0].where), "parts/tiles.json");
  EXPECT_EQ(composed.graph->passes[0].where.pointer, "/passes/0/pass");
  EXPECT_EQ(composed.graph->resources.size(), read(whole_graph()).graph->resources.size());
}

TEST(Include, SharedFileIsIncludedOnce) {
  const std::string outer =
      R"({ "dermis_fragment": 2, "passes": [ { "include": "parts/tiles.json" } ], "exports": ["light"] })";
  const Composed composed = put_together(
      including_graph(
          R"({ "include": "a.json" }, { "include": "b.json" }, { "include": "parts/tiles.json" })"),
      {}, {{"a.json", outer}, {"b.json", outer}, {"parts/tiles.json", tiles_fragment}});
  EXPECT_EQ(pass_names(composed), (std::vector<std::string>{"find", "blur", "copy", "mix"}));
}

TEST(Include, AMessageAboutAFragmentPointsIntoIt) {
  const std::string wrong = test::replaced(tiles_fragment, "view/8", "vieww/8");
  expect_one(put_together(including_graph(), {}, {{"parts/tiles.json", wrong}}),
             Id::unknown_resource, "parts/tiles.json:3:", {"'vieww'"});
  expect_one(put_together(including_graph(), {}, {{"parts/tiles.json", "{ \"dermis\": 2 }"}}),
             Id::other_kind_of_file, "parts/tiles.json:1:3", {"dermis_fragment"});
}

TEST(Include, EqualDeclarationsMerge_DifferentAreRejected) {
  const std::string other = test::replaced(tiles_fragment, "r8_uint", "r16_uint");
  expect_one(
      put_together(including_graph(), {}, {{"parts/tiles.json", other}}), Id::duplicate_name,
      "parts/tiles.json:2:16",
      {"'material' of \"imports\"", "declared differently", "graph.json:", "first declared here"});
}

TEST(Include, LongEqualDeclarationsMerge) {
  std::string words;
  for (int i = 0; i < 300; ++i)
    words += fmt::format("{}\"o{}\": {{}}", i == 0 ? "" : ", ", i);
  // Settings have no such objects: only the reader of the graph may say so, once.
  const std::string settings = fmt::format(R"("settings": {{ "style": {{ {} }} }})", words);
  const Composed composed = put_together(
      fmt::format(R"({{ "dermis": 2, "name": "g", {}, "passes": [ {{ "include": "a.json" }} ] }})",
                  settings),
      {}, {{"a.json", fmt::format(R"({{ "dermis_fragment": 2, {} }})", settings)}});
  for (const Diagnostic& one : composed.diagnostics.list)
    EXPECT_NE(one.id, Id::duplicate_name) << one.text;
}

TEST(Include, ManyDeclarationsJoinInLinearTime) {
  std::string settings;
  for (int i = 0; i < 60000; ++i)
    settings += fmt::format("{}\"s{}\": true", i == 0 ? "" : ", ", i);
  Diagnostics diagnostics;
  auto graph = parse_document(
      "graph.json", R"({ "dermis": 2, "name": "g", "passes": [ { "include": "a.json" } ] })",
      diagnostics);
  const auto composition = compose(
      std::move(*graph), {},
      [&](std::string_view name) {
        return FileText{
            std::string(name),
            fmt::format(R"({{ "dermis_fragment": 2, "settings": {{ {} }} }})", settings), ""};
      },
      diagnostics);
  ASSERT_TRUE(composition) << all_messages(diagnostics);
  EXPECT_EQ(composition->changes.size(), 60000u);
}

TEST(Include, ReplacementWithoutPasses_IsRejected) {
  const Composed composed = put_together(
      including_graph(),
      {overlay(R"({ "replace": "copy", "passes": [{ "include": "parts/tiles.json" }] })")},
      {{"parts/tiles.json", tiles_fragment}});
  expect_one(
      composed, Id::edit_target, "overlay0.json:2:14",
      {"would replace the pass 'copy' with no pass", "were included before", "use 'remove'"});
}

TEST(Include, InsertionOfWhatIsIncluded_IsRejected) {
  const Composed composed = put_together(
      including_graph(),
      {overlay(R"({ "insert_after": "copy", "passes": [{ "include": "parts/tiles.json" }] })")},
      {{"parts/tiles.json", tiles_fragment}});
  expect_one(composed, Id::edit_target, "overlay0.json:2:19", {"adds nothing", "included before"});
}

TEST(Include, OverlaysSeeIncludesAndCanInclude) {
  const Composed changed = put_together(
      including_graph(), {overlay(R"({ "set": "/resources/list/buffer/extra", "to": 8 })")},
      {{"parts/tiles.json", tiles_fragment}});
  ASSERT_TRUE(changed.graph) << all_messages(changed.diagnostics);
  EXPECT_EQ(changed.graph->resources.back().extra_elements, 8u);
  const Composed including = put_together(
      including_graph(R"({ "pass": "gone", "type": "test.list" })"),
      {overlay(R"({ "replace": "gone", "passes": [{ "include": "parts/tiles.json" }] })")},
      {{"parts/tiles.json", tiles_fragment}});
  EXPECT_EQ(pass_names(including), (std::vector<std::string>{"find", "blur", "copy", "mix"}));
}

TEST(Include, PathsOutsideTheRootsAreRejected) {
  for (const char* name : {"/etc/passwd", "../x.json", "a/../../x.json", "a/./x.json", "a//x.json",
                           "a/", "", "C:/x.json", "a\\\\x.json"}) {
    Files files{{name, tiles_fragment}};
    expect_one(
        put_together(including_graph(fmt::format(R"({{ "include": "{}" }})", name)), {}, files),
        Id::bad_file_name, "graph.json:18:18", {"is not a valid file path"});
  }
  expect_one(
      put_together(including_graph(fmt::format(R"({{ "include": "{}" }})", std::string(257, 'a'))),
                   {}),
      Id::bad_file_name, "graph.json:18:18", {"257 bytes"});
}

TEST(Include, MissingFileIsReportedAtTheInclude) {
  expect_one(put_together(including_graph(), {}), Id::file_unreadable, "graph.json:18:18",
             {"'parts/tiles.json'", "it is not there"});
  Diagnostics diagnostics;
  auto document = parse_document("graph.json", including_graph(), diagnostics);
  EXPECT_FALSE(compose(std::move(*document), {}, {}, diagnostics));
  EXPECT_EQ(diagnostics.list[0].id, Id::file_unreadable);
}

TEST(Include, CyclesAreRejectedWithTheWholeChain) {
  const auto including = [](const char* name) {
    return fmt::format(R"({{ "dermis_fragment": 2, "passes": [ {{ "include": "{}" }} ] }})", name);
  };
  expect_one(put_together(including_graph(R"({ "include": "a.json" })"), {},
                          {{"a.json", including("b.json")}, {"b.json", including("a.json")}}),
             Id::include_cycle, "b.json:1:50",
             {"'a.json' includes 'b.json' includes 'a.json'", "graph.json:18:18"});
  expect_one(put_together(including_graph(R"({ "include": "a.json" })"), {},
                          {{"a.json", including("a.json")}}),
             Id::include_cycle, "a.json:1:50", {"'a.json' includes 'a.json'"});
}

TEST(Include, ErrorsInAFragmentNameEachInclude) {
  const Files files{
      {"a.json", R"({ "dermis_fragment": 2, "passes": [ { "include": "b.json" } ] })"},
      {"b.json", R"({ "dermis": 2, "passes": [] })"}};
  expect_one(put_together(including_graph(R"({ "include": "a.json" })"), {}, files),
             Id::other_kind_of_file, "b.json:1:3",
             {"'dermis_fragment' is expected", "a.json:1:50", "'b.json' is included here",
              "graph.json:18:18", "'a.json' is included here"});
}

TEST(Include, DepthAndNumberOfFilesAreLimited) {
  Files chain, many;
  std::string includes;
  for (int i = 0; i < 70; ++i) {
    chain[fmt::format("{}.json", i)] = fmt::format(
        R"({{ "dermis_fragment": 2, "passes": [ {{ "include": "{}.json" }} ] }})", i + 1);
    many[fmt::format("{}.json", i)] = R"({ "dermis_fragment": 2 })";
    includes += fmt::format("{}{{ \"include\": \"{}.json\" }}", i == 0 ? "" : ", ", i);
  }
  expect_one(put_together(including_graph(R"({ "include": "0.json" })"), {}, chain),
             Id::limit_exceeded, "7.json:1:50", {"8 deep"});
  const Composed composed = put_together(including_graph(includes), {}, many);
  ASSERT_FALSE(composed.diagnostics.list.empty());
  EXPECT_EQ(composed.diagnostics.list[0].id, Id::limit_exceeded);
  EXPECT_NE(composed.diagnostics.list[0].text.find("64 files"), std::string::npos);
}

TEST(Include, FragmentCanBeCheckedOnItsOwn) {
  Diagnostics diagnostics;
  auto document = parse_document("tiles.json", tiles_fragment, diagnostics);
  const auto as_graph = compose_fragment(std::move(*document), {}, diagnostics);
  ASSERT_TRUE(as_graph) << all_messages(diagnostics);
  EXPECT_TRUE(read_graph(as_graph->document, pass_types(), diagnostics))
      << all_messages(diagnostics);
}

// An overlay whose edits miss what the graph fails to declare is not to blame.
TEST(Compose, ErrorsOfTheGraph_AreNotBlamedOnTheOverlay) {
  for (
      const char* graph :
      {R"({ "dermis": 2, "name": "g", "pases": [], "exports": [] })",
       R"({ "dermis": 2, "name": "g", "passes": [ { "include": "none.json" } ], "exports": [] })"}) {
    const Composed composed = put_together(graph, {overlay(R"({ "remove": "/passes/scatter" })")});
    EXPECT_FALSE(composed.graph);
    for (const Diagnostic& one : composed.diagnostics.list)
      EXPECT_EQ(composed.diagnostics.files[one.where.file.value].name, "graph.json") << one.text;
  }
}

} // namespace
} // namespace dermis
