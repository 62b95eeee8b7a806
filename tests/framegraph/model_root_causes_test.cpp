// All root causes are reported in one run; their consequences are not reported.

#include "framegraph/text/limits.hpp"
#include "tests/framegraph/model_support.hpp"
#include "tests/support/text_file.hpp"

namespace dermis {
namespace {

using namespace dermis::testing;
using Id = DiagnosticId;

std::string small_graph(const std::string& passes) {
  return R"({ "dermis": 2, "name": "g", "imports": { "a": { "format": "rgba16f", "size": "view" } },
"resources": { "x": { "format": "rgba16f", "size": "view" } }, "exports": ["a"], "passes": [)" +
         passes + "] }";
}

TEST(GraphErrors, TwoPassesThatAlwaysRunDoNotWriteTheSameResource) {
  const Read result = read(small_graph(R"(
{ "pass": "one", "type": "test.blur", "read": { "source": "a" }, "write": { "target": "x" } },
{ "pass": "two", "type": "test.blur", "read": { "source": "a" }, "write": { "target": "x" } })"));
  EXPECT_FALSE(result.graph);
  expect_only(result.diagnostics, Id::two_producers, 4, 87,
              {"'one' and 'two'", "'x'", "'one' writes it here"});
}

TEST(GraphErrors, ResourceOnlyUpdated_HasNoContents) {
  const Read result = read(small_graph(R"(
{ "pass": "one", "type": "test.mix", "read": { "source": "a" }, "write": { "target": "x" } })"));
  EXPECT_FALSE(result.graph);
  expect_only(result.diagnostics, Id::no_producer, 3, 86,
              {"pass 'one' updates 'x'", "only update"});
}

TEST(GraphErrors, ResourceNeverWritten_CannotBeRead) {
  const Read result = read(small_graph(R"(
{ "pass": "one", "type": "test.mix", "read": { "source": "x" }, "write": { "target": "a" } },
{ "pass": "two", "type": "test.mix", "read": { "source": "x" }, "write": { "target": "a" } })"));
  EXPECT_FALSE(result.graph);
  expect_only(result.diagnostics, Id::no_producer, 3, 58,
              {"pass 'one' reads 'x'", "declared here"});
}

TEST(GraphErrors, OnlyRootCausesAreReportedInOneRun) {
  // Gives no diagnostic for readers of `material`.
  std::string text = damaged("\"r8_uint\"", "\"r8uint\"");
  // Gives no diagnostic for "$samples".
  text = test::replaced(text, "\"int\": 16", "\"int\": 1.5");
  // Gives no diagnostic for the reader of `list`.
  text = test::replaced(text, "\"type\": \"test.list\"", "\"type\": \"test.lisst\"");
  text = test::replaced(text, "\"kept@-2\"", "\"keptt@-2\"");
  const Read result = read(text);
  EXPECT_FALSE(result.graph);
  ASSERT_EQ(result.diagnostics.list.size(), 4u) << all_messages(result.diagnostics);
  EXPECT_EQ(result.diagnostics.list[0].id, Id::wrong_type);
  EXPECT_EQ(result.diagnostics.list[1].id, Id::invalid_value);
  EXPECT_EQ(result.diagnostics.list[2].id, Id::unknown_pass_type);
  EXPECT_EQ(result.diagnostics.list[3].id, Id::unknown_resource);
}

TEST(GraphErrors, UnknownPassType_IsReportedOnceWithAllPasses) {
  std::string text = whole_graph();
  for (size_t at = 0; (at = text.find("\"test.blur\"", at)) != std::string::npos; ++at)
    text.replace(at, 11, "\"host.bloom\"");
  const size_t end = text.rfind("\"passes\": [") + 11;
  text.insert(end, R"( { "pass": "extra", "type": "host.bloom" },)");
  const Read result = read(text);
  ASSERT_EQ(result.diagnostics.list.size(), 1u) << all_messages(result.diagnostics);
  const Diagnostic& one = result.diagnostics.list[0];
  EXPECT_EQ(one.id, Id::unknown_pass_type);
  EXPECT_NE(one.text.find("pass 'extra' and "), std::string::npos) << one.text;
  ASSERT_FALSE(one.related.empty());
  EXPECT_EQ(one.related[0].second, "pass 'blur' also has this type");
  EXPECT_NE(std::string(diagnostic_info(one.id).hint).find("--pass-types FILE"), std::string::npos);
}

TEST(GraphErrors, WrongSectionType_SuppressesReferenceErrors) {
  for (const char* section : {"settings", "imports", "resources", "passes"}) {
    std::string text = whole_graph();
    const std::string key = std::string("  \"") + section + "\": ";
    const size_t at = text.find(key) + key.size();
    text.insert(at, "7, \"note_moved\": ");
    const Read result = read(text);
    EXPECT_FALSE(result.graph);
    ASSERT_EQ(result.diagnostics.list.size(), 2u) << section << "\n"
                                                  << all_messages(result.diagnostics);
    EXPECT_EQ(result.diagnostics.list[0].id, Id::wrong_type);
    EXPECT_EQ(result.diagnostics.list[1].id, Id::unknown_key);
  }
}

TEST(GraphErrors, CountsBeyondTheLimitsAreRejected) {
  std::string many_passes, many_resources, many_settings;
  for (size_t i = 0; i <= limits::passes; ++i)
    many_passes += (i ? ",{}" : "{}");
  for (size_t i = 0; i <= limits::resources; ++i)
    many_resources += (i ? ",\"r" : "\"r") + std::to_string(i) + "\":{}";
  for (size_t i = 0; i <= limits::settings; ++i)
    many_settings += (i ? ",\"s" : "\"s") + std::to_string(i) + "\":{}";
  const std::string start = "{ \"dermis\": 2, \"name\": \"g\", ";
  expect_only(read(start + "\"exports\": [],\n\"passes\": [" + many_passes + "] }").diagnostics,
              Id::limit_exceeded, 2, 11, {"4097", "4096"});
  const std::string rest = "\"exports\": [], \"passes\": [],\n";
  expect_only(read(start + rest + "\"resources\": {" + many_resources + "} }").diagnostics,
              Id::limit_exceeded, 2, 14, {"4096"});
  expect_only(read(start + rest + "\"settings\": {" + many_settings + "} }").diagnostics,
              Id::limit_exceeded, 2, 13, {"256"});
}

} // namespace
} // namespace dermis
