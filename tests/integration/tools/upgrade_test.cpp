// Tests `dermis upgrade` on files of version 1. version_1.tar.xz has the graphs, overlays, tables
// and pass type files that were shipped with version 1, and further graphs in the folder `cases`.

#include "tests/integration/tools/command_fixture.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdlib>
#include <sstream>

namespace dermis::test {
namespace {

struct Upgrade : CommandTest {
  // Unpacks the old files into the test's folder and returns their paths.
  std::vector<std::string> unpack() const {
    const std::string archive = DERMIS_SOURCE_DIR "/tests/integration/tools/version_1.tar.xz";
    const std::string line = "tar -xJf '" + archive + "' -C '" + path("") + "'";
    EXPECT_EQ(std::system(line.c_str()), 0);
    std::vector<std::string> paths;
    for (const std::string& name : files())
      if (name.ends_with(".json")) paths.push_back(path(name));
    return paths;
  }
};

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);)
    lines.push_back(line);
  return lines;
}

std::vector<std::string> comments_of(const std::string& text) {
  std::vector<std::string> comments;
  for (const std::string& line : lines_of(text))
    if (const size_t at = line.find("// "); at != std::string::npos)
      comments.push_back(line.substr(at));
  return comments;
}

TEST_F(Upgrade, OldFiles_Validate_OneDiagnosticNamesTheVerb) {
  const std::vector<std::string> old = unpack();
  ASSERT_GE(old.size(), 50u);
  for (const std::string& file : old) {
    const Outcome outcome = run({"validate", file, "--json"});
    EXPECT_EQ(outcome.exit_code, 1) << file;
    EXPECT_THAT(outcome.out, HasAll("D0110", "`dermis upgrade FILE`")) << file;
    size_t diagnostics = 0;
    for (size_t at = 0; (at = outcome.out.find("\"id\": \"D", at)) != std::string::npos; ++at)
      ++diagnostics;
    EXPECT_EQ(diagnostics, 1u) << file << outcome.out;
  }
}

TEST_F(Upgrade, LinksAndPermissionsStay) {
  namespace fs = std::filesystem;
  const std::string file = unpack().front(), link = path("link.json");
  fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink(file, link);
  EXPECT_THAT(run({"upgrade", link}), Succeeds("upgraded"));
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(run({"upgrade", "--check", file}).exit_code, 0);
  EXPECT_EQ(fs::status(file).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(Upgrade, OldFiles_Upgrade_CommentsAndLinesStay) {
  for (const std::string& file : unpack()) {
    const std::string before = read_text(file);
    EXPECT_EQ(run({"upgrade", "--check", file}).exit_code, 1) << file;
    EXPECT_EQ(read_text(file), before) << "--check writes nothing";
    EXPECT_THAT(run({"upgrade", file}), Succeeds("upgraded to version 2"));
    const std::string after = read_text(file);
    EXPECT_EQ(lines_of(after).size(), lines_of(before).size()) << file;
    EXPECT_EQ(comments_of(after), comments_of(before)) << file;
    EXPECT_EQ(run({"upgrade", "--check", file}).exit_code, 0) << "a second upgrade changes nothing";
    EXPECT_EQ(run({"upgrade", file}).exit_code, 0);
    EXPECT_EQ(read_text(file), after);
  }
}

// A carriage return ends a comment, too.
TEST_F(Upgrade, CommentsMayEndWithACarriageReturn) {
  const std::string file = write(
      "old.json", "//x\r{\"dermis\":1,\"name\":\"g\",\"passes\":[{\"pass\":\"s\",\"kind\":"
                  "\"subsurface.separable\",\"read\":{\"light\":\"l\",\"material\":\"m\",\"depth\":"
                  "\"d\"},\"write\":{\"scattered\":\"o\"}}],\"exports\":[]}");
  EXPECT_THAT(run({"upgrade", file}), Succeeds("upgraded to version 2"));
  EXPECT_THAT(read_text(file), HasAll("//x\r{", "\"type\":"));
}

TEST_F(Upgrade, OldShippedFiles_Upgrade_Compile) {
  for (const std::string& file : unpack())
    ASSERT_EQ(run({"upgrade", file}).exit_code, 0) << file;
  for (const std::string& name : files("graphs")) {
    EXPECT_THAT(run({"explain", path("graphs/" + name), "--json"}), Succeeds()) << name;
  }
  for (const char* name :
       {"overlays/accumulate.json", "overlays/skips.json", "overlays/probe.json"})
    EXPECT_EQ(run({"explain", path("graphs/sap.json"), "--overlay", path(name)}).exit_code, 0)
        << name;
  EXPECT_EQ(run({"validate", path("choice/errors.json"), path("choice/calibration.json"),
                 path("cases/kinds.json"), path("cases/qa_kinds.json")})
                .exit_code,
            0);
}

// The graphs in cases/ that were valid in version 1 stay valid, the others stay invalid.
TEST_F(Upgrade, OldCases_Upgrade_StayAsValidAsBefore) {
  const std::vector<std::string> invalid = {
      "bloom_otherwise2.json",    "bloom_readself.json", "chain_half_written.json",
      "format_alternatives.json", "half.json",           "inplace_blur.json",
      "otherwise_inplace.json",   "three.json",          "x_inc_dup.json",
      "x_inc_missing.json",       "x_inc_prefix.json",   "x_inc_up.json",
      "x_inc_when.json"};
  for (const std::string& file : unpack())
    ASSERT_EQ(run({"upgrade", file}).exit_code, 0) << file;
  for (const std::string& name : files("cases")) {
    const bool valid = std::find(invalid.begin(), invalid.end(), name) == invalid.end();
    const Outcome outcome =
        run({"validate", path("cases/" + name), "--pass-types", path("cases/kinds.json"),
             "--pass-types", path("cases/qa_kinds.json")});
    EXPECT_EQ(outcome.exit_code, valid ? 0 : 1) << name << outcome.err;
    EXPECT_THAT(outcome.err, Not(HasSubstr("D0110"))) << name;
  }
}

TEST_F(Upgrade, Pass_Upgrade_RenamesTypePortsAndSettings) {
  const std::string graph = write("graph.json", R"({ "dermis": 1, "name": "g", // kind: stays
  "passes": [ { "pass": "mend", /**/ "kind": "x" } ], "exports": [] })");
  EXPECT_EQ(run({"upgrade", graph}).exit_code, 1) << "block comments are no JSON";
  const std::string good = write("good.json", R"({ "dermis":   1, "name": "kind", // "kind": stays
  "passes": [ { "pass": "mend", "kind" : "subsurface.mend", // "share"
    "read": { "shares": "shares@-1" }, "set": { "share": "$share", "below": 1 } },
    { "pass": "mend2", "kind": "mine.mend", "set": { "share": 1 } } ], "exports": ["doubts"] })");
  EXPECT_EQ(run({"upgrade", good}).exit_code, 0);
  EXPECT_EQ(read_text(good), R"({ "dermis":   2, "name": "kind", // "kind": stays
  "passes": [ { "pass": "refine_tiles", "type" : "subsurface.tile_refine", // "share"
    "read": { "samples_per_tile": "shares@-1" }, "set": { "sample_weight": "$share", "below": 1 } },
    { "pass": "mend2", "type": "mine.mend", "set": { "share": 1 } } ], "exports": ["doubts"] })");
}

TEST_F(Upgrade, Ports_Upgrade_RenamedOnlyInTheirTypes) {
  const std::string graph = write("ports.json", R"({ "dermis": 1, "name": "g", "passes": [
  { "pass": "b", "kind": "subsurface.brightness", "write": { "brightness": "brightness" } },
  { "pass": "r", "kind": "subsurface.residual", "read": { "brightness": "brightness" } },
  { "pass": "s", "kind": "subsurface.skips", "write": { "skips": "skips" } },
  { "pass": "m", "kind": "mine.x", "write": { "brightness": "skips" } } ], "exports": ["skips"] })");
  EXPECT_EQ(run({"upgrade", graph}).exit_code, 0);
  EXPECT_EQ(read_text(graph), R"({ "dermis": 2, "name": "g", "passes": [
  { "pass": "b", "type": "subsurface.global_light_change", "write": { "luminance_change": "brightness" } },
  { "pass": "r", "type": "subsurface.residual", "read": { "luminance_change": "brightness" } },
  { "pass": "s", "type": "subsurface.debug_tile_class", "write": { "tile_class": "skips" } },
  { "pass": "m", "type": "mine.x", "write": { "brightness": "skips" } } ], "exports": ["skips"] })");
}

TEST_F(Upgrade, NewPorts_Upgrade_AreAddedWithTheirResource) {
  const std::string graph = write("list.json", R"({ "dermis": 1, "name": "g",
  "resources": { "classes": 1 }, "passes": [
  { "pass": "c", "kind": "subsurface.classify", "write": { "classes": "classes" } }, // classes
  { "pass": "l", "kind": "subsurface.tile_list", "write": {} } ], "exports": [] })");
  EXPECT_EQ(run({"upgrade", graph}).exit_code, 0);
  EXPECT_EQ(read_text(graph), R"({ "dermis": 2, "name": "g",
  "resources": { "list_state": { "buffer": { "stride": 4, "count": "view/64", "extra": 8 } }, "classes": 1 }, "passes": [
  { "pass": "c", "type": "subsurface.classify", "write": { "list_state": "list_state", "classes": "classes" } }, // classes
  { "pass": "l", "type": "subsurface.tile_list", "write": { "list_state": "list_state" } } ], "exports": [] })");
  const std::string part = write("part.json", R"({ "dermis_fragment": 1, "passes": [
  { "pass": "l", "kind": "subsurface.sap_tiles", "read": { "classes": "props" }, "write": { "tiles": "tiles" } } ] })");
  EXPECT_EQ(run({"upgrade", part}).exit_code, 0);
  EXPECT_THAT(read_text(part),
              HasAll("{ \"resources\": { \"list_state_of_props\": { ",
                     "\"write\": { \"list_state\": \"list_state_of_props\", \"tiles\""));
}

// Removed members may be neighbours, all members of an object, and next to a comment.
TEST_F(Upgrade, Levels_Upgrade_BecomeOneImage) {
  const std::string types[] = {"afis", "afis_tiles", "guided"};
  const std::string reads[] = {R"("level_1": "l1", "level_2": "l2", "level_3": "l3")",
                               R"("level_2": "l2", "level_1": "l1", "light": "light")",
                               R"("light": "light", "level_1": "l1", "level_2": "l2" // the last
    )",
                               R"("level_1": "l1",
      "level_2": "l2", // second
      "level_3": "l3" // third
      , "light": "light")"};
  const std::string resources[] = {
      R"("l1": { "image": 1 }, "l2": { "image": 1 }, "l3": { "image": 1 })",
      R"("other": {}, // stays
    "l1": { "image": 1 },
    "l2": { "image": 1 })",
      R"("l2": { "image": 1 }, "other": {}, "l1": { "image": 1 } // last
    )"};
  for (const std::string& type : types)
    for (const std::string& read : reads)
      for (const std::string& declared : resources) {
        const std::string old = fmt::format(
            R"({{ "dermis": 1, "name": "g", "resources": {{ {} }}, "passes": [
  {{ "pass": "p", "kind": "subsurface.{}", "read": {{ {} }} }} ], "exports": [] }})",
            declared, type, read);
        const std::string graph = write("graph.json", old);
        ASSERT_THAT(run({"upgrade", graph}), Succeeds("upgraded")) << old;
        const std::string text = read_text(graph);
        EXPECT_EQ(comments_of(text), comments_of(old)) << text;
        EXPECT_EQ(lines_of(text).size(), lines_of(old).size()) << text;
        const auto json = nlohmann::json::parse(text, nullptr, false, true);
        ASSERT_FALSE(json.is_discarded()) << text;
        EXPECT_EQ(json["passes"][0]["read"].count("levels"), 1u) << text;
        for (const char* gone : {"level_1", "level_2", "level_3"})
          EXPECT_EQ(json["passes"][0]["read"].count(gone), 0u) << text;
        for (const char* gone : {"l1", "l2"})
          EXPECT_EQ(json["resources"].count(gone), 0u) << text;
        EXPECT_EQ(json["resources"].count("levels_of_l1"), 1u) << text;
      }
}

TEST_F(Upgrade, EscapedText_StaysJson) {
  const std::string overlay = write("overlay.json", R"({ "dermis_overlay": 1, "edits": [
  { "remove": "/passes/mend/set/a\"b\\" } ] })");
  EXPECT_EQ(run({"upgrade", overlay}).exit_code, 0);
  EXPECT_THAT(read_text(overlay), HasSubstr(R"("/passes/refine_tiles/set/a\"b\\")"));
}

TEST_F(Upgrade, PassTypesWithTheNewKey_Upgrade) {
  const std::string file = write("types.json", R"({ "dermis_pass_types": 1, "pass_types": [] })");
  EXPECT_THAT(run({"upgrade", file}), Succeeds("upgraded to version 2"));
  EXPECT_EQ(read_text(file), R"({ "dermis_pass_types": 2, "pass_types": [] })");
}

TEST_F(Upgrade, StandardInput_ResultIsTheWholeOutput) {
  RunOptions options;
  options.input = R"({ "dermis": 1, "name": "g", "passes": [], "exports": [] })";
  const Outcome upgraded = run({"upgrade", "-"}, options);
  EXPECT_EQ(upgraded.out, R"({ "dermis": 2, "name": "g", "passes": [], "exports": [] })");
  options.input = upgraded.out;
  EXPECT_EQ(run({"upgrade", "-"}, options).out, upgraded.out) << "nothing to do";
  EXPECT_EQ(run({"upgrade", "-", "--json"}, options).exit_code, 2);
  EXPECT_THAT(run({"upgrade", "-", "--check", "--json"}, options), Succeeds(IsJson()));
}

TEST_F(Upgrade, Overlay_Upgrade_RenamesTargetsAndPaths) {
  const std::string overlay = write("overlay.json", R"({ "dermis_overlay": 1, "edits": [
  { "insert_before": "hand_out", "passes": [ { "pass": "p", "kind": "subsurface.copy" } ] },
  { "set": "/passes/doubt/write/doubts", "to": "d" }, { "set": "/passes/x/kind", "to": "subsurface.light" },
  { "set": "/settings/kind", "to": 1 }, { "remove": "/passes/mend/set/share" } ] })");
  EXPECT_EQ(run({"upgrade", overlay}).exit_code, 0);
  EXPECT_EQ(read_text(overlay), R"({ "dermis_overlay": 2, "edits": [
  { "insert_before": "export_scattered", "passes": [ { "pass": "p", "type": "subsurface.copy_tiles" } ] },
  { "set": "/passes/estimate_tile_error/write/tile_errors", "to": "d" }, { "set": "/passes/x/type", "to": "subsurface.export_scattered" },
  { "set": "/settings/kind", "to": 1 }, { "remove": "/passes/refine_tiles/set/sample_weight" } ] })");
}

TEST_F(Upgrade, UnwritableFile_Upgrade_FailsAndKeepsTheFile) {
  const std::string good =
      write("good.json", R"({ "dermis": 1, "name": "g", "passes": [], "exports": [] })");
  const std::string missing = path("none.json");
  EXPECT_THAT(run({"upgrade", missing, good}), FailsWith(1));
  EXPECT_THAT(read_text(good), HasSubstr("\"dermis\": 2")) << "other files are upgraded";
}

} // namespace
} // namespace dermis::test
