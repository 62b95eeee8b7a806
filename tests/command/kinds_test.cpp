// Pass kinds of a host, known to the verbs that look at graphs through the file that the host exported.
#include "tests/command/command_fixture.hpp"

namespace dermis::test {
namespace {

using ::testing::HasSubstr;

constexpr const char* kinds = R"({ "dermis_kinds": 1, "kinds": [
  { "name": "studio.tone", "ports": [ { "name": "light", "usage": "sampled_image" },
                                      { "name": "toned", "usage": "storage_image_write" } ],
    "settings": [ { "name": "level", "type": "real", "default": 1, "min": 0, "max": 4 } ] } ] })";
constexpr const char* tone = R"({ "dermis": 1, "name": "tone",
  "imports": { "light": { "format": "rgba16f", "size": "view" } },
  "resources": { "out": { "format": "rgba16f", "size": "view" } },
  "passes": [ { "pass": "tone", "kind": "studio.tone", "read": { "light": "light" }, "write": { "toned": "out" },
                "set": { "level": 2 } } ],
  "exports": ["out"] })";

class Kinds : public CommandTest {};

TEST_F(Kinds, OfAHostLetItsGraphsBeCheckedWithoutIt) {
  const std::string kind_file = write("kinds.json", kinds), graph_file = write("tone.json", tone);
  const Outcome without = run({"validate", graph_file});
  EXPECT_EQ(without.exit_code, 1);
  EXPECT_THAT(without.err, HasSubstr("studio.tone"));
  const Outcome with = run({"validate", graph_file, "--kinds", kind_file});
  EXPECT_EQ(with.exit_code, 0) << with.err;
  const Outcome explained = run({"explain", graph_file, "--kinds", kind_file});
  EXPECT_EQ(explained.exit_code, 0) << explained.err;
  EXPECT_THAT(explained.out, HasSubstr("tone"));
}

TEST_F(Kinds, AreCheckedThemselves) {
  EXPECT_EQ(run({"validate", write("kinds.json", kinds)}).exit_code, 0);
  std::string range = kinds, own = kinds;
  range.replace(range.find("\"default\": 1"), 12, "\"default\": 9");
  const Outcome refused = run({"validate", write("range.json", range)});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err, HasSubstr("range.json:2:3"));
  EXPECT_THAT(refused.err, HasSubstr("settings[0]"));
  own.replace(own.find("studio"), 6, "subsurface");
  EXPECT_THAT(run({"validate", write("own.json", own)}).err, HasSubstr("are the library's"));
  const std::string graph_file = write("tone.json", tone);
  const std::string kind_file = write("kinds.json", kinds);
  const Outcome twice = run({"validate", graph_file, "--kinds", kind_file, "--kinds", kind_file});
  EXPECT_EQ(twice.exit_code, 1);
  EXPECT_THAT(twice.err, HasSubstr("there is a kind 'studio.tone' already"));
}

} // namespace
} // namespace dermis::test
