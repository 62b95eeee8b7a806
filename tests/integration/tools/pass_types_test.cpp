// Tests pass types of a host: verbs that read graphs know them from the file that the host
// exported.
#include "tests/integration/tools/command_fixture.hpp"

#include <nlohmann/json.hpp>

namespace dermis::test {
namespace {

constexpr const char* pass_types = R"({ "dermis_pass_types": 2, "pass_types": [
  { "name": "studio.tone", "ports": [ { "name": "light", "usage": "sampled_image" },
                                      { "name": "toned", "usage": "storage_image_write" } ],
    "settings": [ { "name": "level", "type": "real", "default": 1, "min": 0, "max": 4 } ] } ] })";
constexpr const char* tone = R"({ "dermis": 2, "name": "tone",
  "imports": { "light": { "format": "rgba16f", "size": "view" } },
  "resources": { "out": { "format": "rgba16f", "size": "view" } },
  "passes": [ { "pass": "tone", "type": "studio.tone", "read": { "light": "light" }, "write": { "toned": "out" },
                "set": { "level": 2 } } ],
  "exports": ["out"] })";

class PassTypes : public CommandTest {};

TEST_F(PassTypes, ExportedFile_LetsGraphsBeChecked) {
  const std::string pass_types_file = write("pass_types.json", pass_types),
                    graph_file = write("tone.json", tone);
  EXPECT_THAT(run({"validate", graph_file}), FailsWith(1, "studio.tone"));
  EXPECT_THAT(run({"validate", graph_file, "--pass-types", pass_types_file}), Succeeds());
  EXPECT_THAT(run({"explain", graph_file, "--pass-types", pass_types_file}), Succeeds("tone"));
}

TEST_F(PassTypes, FileIsChecked) {
  EXPECT_EQ(run({"validate", write("pass_types.json", pass_types)}).exit_code, 0);
  const auto validate = [&](const std::string& name, const char* from, const char* to) {
    return run({"validate", write(name, replaced(pass_types, from, to))});
  };
  EXPECT_THAT(validate("range.json", "\"default\": 1", "\"default\": 9"),
              FailsWith(1, "range.json:2:3", "settings[0]"));
  EXPECT_THAT(validate("own.json", "studio", "subsurface").err,
              HasSubstr("are reserved for the library"));
  EXPECT_THAT(validate("reads.json", R"("usage": "sampled_image")",
                       R"("usage": "sampled_image", "internally_ordered": true)"),
              FailsWith(1, "reads.json:2:3", "D0233", "has usage sampled_image"));
  const std::string graph_file = write("tone.json", tone);
  const std::string pass_types_file = write("pass_types.json", pass_types);
  EXPECT_THAT(run({"validate", graph_file, "--pass-types", pass_types_file, "--pass-types",
                   pass_types_file}),
              FailsWith(1, "pass_types.json:2:13", "there is a pass type 'studio.tone' already"));
}

TEST_F(PassTypes, SchemaKnowsThem) {
  const std::string pass_types_file = write("pass_types.json", pass_types);
  EXPECT_THAT(run({"schema", "graph"}).out, Not(HasSubstr("studio.tone")));
  const Outcome outcome = run({"schema", "graph", "--pass-types", pass_types_file});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const nlohmann::json schema = nlohmann::json::parse(outcome.out);
  const auto& types = schema["definitions"]["pass_of_a_kind"]["allOf"];
  EXPECT_THAT(types.back().dump(),
              AllOf(HasSubstr("studio.tone"), HasSubstr("toned"), HasSubstr("level")));
  EXPECT_THAT(run({"schema", "fragment", "--pass-types", write("broken.json", "{")}),
              FailsWith(1, "broken.json:1:2"));
}

// burley with a host pass after it, which a setting turns on.
constexpr const char* toned = R"({ "dermis_overlay": 2, "edits": [
  { "set": "/settings/toned", "to": { "bool": false } },
  { "set": "/resources/toned_light", "to": { "format": "rgba16f", "size": "view", "optional": true } },
  { "set": "/exports/-", "to": "toned_light" },
  { "insert_after": "combine", "passes": [ { "pass": "tone", "type": "studio.tone", "when": "toned",
    "read": { "light": "lighting" }, "write": { "toned": "toned_light" } } ] } ] })";

TEST_F(PassTypes, RepeatedOption_KeepsTheGraphArgument) {
  const std::string pass_types_file = write("pass_types.json", pass_types),
                    graph_file = write("tone.json", tone);
  const std::vector<std::vector<std::string>> lines{
      {"explain", "--pass-types", pass_types_file, graph_file, "--size", "64x64"},
      {"explain", "--pass-types", pass_types_file, "--root", path(""), graph_file},
      {"validate", "--pass-types", pass_types_file, graph_file},
      {"graph", "--pass-types", pass_types_file, graph_file},
      {"explain", "--unbound", "albedo", burley},
      {"explain", "--set", "samples=16", burley, "--set", "texturing=pre"}};
  for (const auto& line : lines) {
    const Outcome outcome = run(line);
    EXPECT_NE(outcome.exit_code, 2) << line[0] << " " << line[1] << "\n" << outcome.err;
    EXPECT_THAT(outcome.err, Not(HasSubstr("required")));
  }
}

TEST_F(PassTypes, Expectations_AcceptHostPassTypes) {
  const std::string pass_types_file = write("pass_types.json", pass_types);
  write("tone.json", tone);
  const std::string expectations = write("tone.expect.json", R"({ "dermis_expect": 1, "cases": [
  { "case": "as_it_is" } ] })");
  EXPECT_THAT(run({"test", "--pass-types", pass_types_file, expectations, "--update"}), Succeeds());
  EXPECT_EQ(run({"test", expectations, "--pass-types", pass_types_file}).exit_code, 0);
  EXPECT_EQ(run({"test", expectations}).exit_code, 1);
}

TEST_F(PassTypes, DisabledPass_DoesNotPreventRendering) {
  const std::string pass_types_file = write("pass_types.json", pass_types),
                    overlay = write("toned.json", toned);
  const std::vector<std::string> line{"render",       "configs/scenes/bust.json",
                                      "--graph",      burley,
                                      "--overlay",    overlay,
                                      "--pass-types", pass_types_file,
                                      "--out",        path("out"),
                                      "--size",       "32x24",
                                      "--frames",     "1",
                                      "--subset",     "0"};
  EXPECT_THAT(run(line), Succeeds());
}

TEST_F(PassTypes, EnabledPass_IsRejectedByName) {
  const std::string side_effects =
      write("effects.json", R"({ "dermis_pass_types": 2, "pass_types": [
  { "name": "studio.look", "side_effects": true, "ports": [ { "name": "light", "usage": "sampled_image" } ] } ] })");
  const std::string look = write("look.json", R"({ "dermis_overlay": 2, "edits": [
  { "insert_before": "classify", "passes": [ { "pass": "look", "type": "studio.look", "read": { "light": "lighting" } } ] } ] })");
  const std::vector<std::string> both{"--graph", burley,         "--overlay",
                                      look,      "--pass-types", side_effects};
  std::vector<std::string> rendering{"render",   "configs/scenes/bust.json",
                                     "--out",    path("out"),
                                     "--size",   "32x24",
                                     "--frames", "1",
                                     "--subset", "0"};
  rendering.insert(rendering.end(), both.begin(), both.end());
  EXPECT_THAT(run(rendering),
              FailsWith(1, "pass 'look' (studio.look) has no kernel here; embed Dermis or turn the "
                           "pass off"));
  EXPECT_THAT(files(), Not(Contains(HasSubstr("frame_"))));
  ASSERT_EQ(run({"capture", "configs/scenes/bust.json", "--out", path("capture"), "--size", "32x24",
                 "--frames", "1"})
                .exit_code,
            0);
  std::vector<std::string> applying{"apply", "--frames", path("capture"), "--out", path("applied")};
  applying.insert(applying.end(), both.begin(), both.end());
  EXPECT_THAT(run(applying), FailsWith(1, "pass 'look' (studio.look) has no kernel here"));
}

TEST_F(PassTypes, BugReport_NamesHostPassTypesInItsCommand) {
  const std::string pass_types_file = write("pass_types.json", pass_types),
                    overlay = write("toned.json", toned);
  ASSERT_THAT(run({"report-bug", burley, "--overlay", overlay, "--pass-types", pass_types_file,
                   "--size", "32x18", "--count", "1", "--out", path("bug")}),
              Succeeds());
  EXPECT_THAT(
      read("bug/README.txt"),
      HasSubstr("dermis apply --graph graph/burley.json --frames capture --out replay --overlay "
                "overlays/0_toned.json --pass-types pass_types/0_pass_types.json\n"));
  EXPECT_THAT(
      run({"apply", "--graph", path("bug/graph/burley.json"), "--frames", path("bug/capture"),
           "--out", path("replay"), "--overlay", path("bug/overlays/0_toned.json"), "--pass-types",
           path("bug/pass_types/0_pass_types.json")}),
      Succeeds());
}

TEST_F(PassTypes, PageCreatesItsFolder) {
  const std::string page = path("pages/new/tone.html");
  EXPECT_THAT(run({"graph", "--pass-types", write("pass_types.json", pass_types),
                   write("tone.json", tone), "--html", page}),
              Succeeds());
  EXPECT_FALSE(read("pages/new/tone.html").empty());
}

} // namespace
} // namespace dermis::test
