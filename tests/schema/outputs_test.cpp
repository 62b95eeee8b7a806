// Tests that SARIF and JUnit output follow their standards.
#include "framegraph/model/read_graph.hpp"
#include "framegraph/text/document.hpp"
#include "integration/tools/command/expect/junit.hpp"
#include "passes/common/pass_types.hpp"
#include "tests/schema/validator.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <unistd.h>

namespace dermis::testing {
namespace {

using nlohmann::json;

// Returns the messages of a graph with this file name as SARIF.
json sarif_of(const std::string& name, const std::string& text) {
  Diagnostics diagnostics;
  const PassTypeRegistry pass_types = subsurface::make_pass_types();
  if (const auto document = parse_document(name, text, diagnostics))
    read_graph(*document, pass_types, diagnostics);
  return json::parse(format_as_sarif(diagnostics, "1.2.3"));
}

TEST(Outputs, SarifFollowsTheStandard) {
  const SchemaFile schema = schema_in("tests/schema/sarif.schema.json");
  const std::pair<const char*, const char*> cases[] = {
      {"good.json", R"({ "dermis": 2, "name": "good", "passes": [], "exports": [] })"},
      {"broken.json", "{ \"dermis\": 2,"},
      {"a b/\xc3\xa4 [1]%.json", R"({ "dermis": 2, "nam": "x" })"},
      {"/absolute/path.json", R"({ "dermis": 9 })"},
      {"twice.json",
       R"({ "dermis": 2, "name": "twice", "imports": { "a": { "format": "rgba16f", "size": "view" } },
         "resources": { "a": { "format": "rgba16f", "size": "view" } }, "passes": [ { "pass": "p", "type": "none" },
         { "pass": "p", "type": "subsurface.combine", "write": { "lighting": "b" } } ], "exports": ["c"] })"}};
  for (const auto& [name, text] : cases) {
    const json log = sarif_of(name, text);
    EXPECT_TRUE(schema.accepts(log)) << name << "\n" << schema.first_problem(log) << log.dump(1);
    for (const json& result : log["runs"][0]["results"]) // 3.27.6: the index is that of the rule.
      EXPECT_EQ(log["runs"][0]["tool"]["driver"]["rules"][result["ruleIndex"].get<size_t>()]["id"],
                result["ruleId"]);
  }
  EXPECT_GE(sarif_of(cases[4].first, cases[4].second)["runs"][0]["results"].size(), 3u);
}

TEST(Outputs, SarifSchemaRejectsInvalidFiles) {
  const SchemaFile schema = schema_in("tests/schema/sarif.schema.json");
  json log = sarif_of("broken.json", "{");
  ASSERT_TRUE(schema.accepts(log));
  json damaged = log;
  damaged["version"] = "2.0.0";
  EXPECT_FALSE(schema.accepts(damaged));
  damaged = log;
  damaged["runs"][0]["results"][0]["level"] = "fatal";
  EXPECT_FALSE(schema.accepts(damaged));
  damaged = log;
  damaged["runs"][0]["results"][0]["locations"][0]["physicalLocation"]["region"]["startLine"] = 0;
  EXPECT_FALSE(schema.accepts(damaged));
}

// Returns whether xmllint (libxml2-utils) accepts the text by junit.xsd; -1 if xmllint is not
// installed.
int xmllint_says(const std::string& text) {
  if (std::system("command -v xmllint > /dev/null 2>&1") != 0) return -1;
  const auto file = std::filesystem::temp_directory_path() /
                    ("dermis_junit_" + std::to_string(getpid()) + ".xml");
  std::ofstream(file) << text;
  const int code =
      std::system(("xmllint --noout --schema " DERMIS_SOURCE_DIR "/tests/schema/junit.xsd '" +
                   file.string() + "' > /dev/null 2>&1")
                      .c_str());
  std::filesystem::remove(file);
  return code == 0 ? 1 : 0;
}

TEST(Outputs, JUnitFollowsTheFormatOfBuildServers) {
  const std::string results = tools::junit_xml(
      {{"configs/\"a\" & <b>.expect.json",
        {{"good", true, "", ""}, {"bad \x01 case", false, "why: <x> & \"y\"", "- a\n+ b]]>\n"}}},
       {"empty", {}}});
  const int verdict = xmllint_says(results);
  if (verdict < 0) GTEST_SKIP() << "xmllint is not installed (Debian: libxml2-utils)";
  EXPECT_EQ(verdict, 1) << results;
  EXPECT_EQ(xmllint_says(tools::junit_xml({})), 1);
  EXPECT_EQ(xmllint_says("<testsuites tests='1' failures='0'><testcase/></testsuites>"), 0);
}

} // namespace
} // namespace dermis::testing
