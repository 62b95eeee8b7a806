#include "framegraph/text/diagnostic.hpp"
#include "framegraph/text/document.hpp"
#include "framegraph/text/limits.hpp"
#include "tests/framegraph/text_support.hpp"

#include <fstream>
#include <sstream>

namespace dermis {
namespace {

Diagnostics with_text(std::string text) {
  Diagnostics out;
  out.files.push_back({"a.json", std::move(text)});
  return out;
}

TEST(Diagnostic, TextForm_HasPlaceIdExcerptCaretAndHint) {
  Diagnostics all = with_text("{\n  \"sise\": 1\n}");
  all.add(DiagnosticId::unknown_key, {{0}, 2, 3, "/sise"}, "import 'depth' has no key 'sise'")
      .suggestion = "did you mean 'size'?";
  EXPECT_EQ(format_for_people(all, all.list[0]),
            "a.json:2:3: error[D0103 unknown_key]: import 'depth' has "
            "no key 'sise'; did you mean 'size'? (at /sise)\n"
            "     2 |   \"sise\": 1\n"
            "       |   ^\n"
            "  Remove the key or correct its spelling.");
}

TEST(Diagnostic, TheCaretCountsCodePointsAndTabsAsOneColumn) {
  Diagnostics all = with_text("\t\xc3\xa9\xc3\xa9 x");
  all.add(DiagnosticId::syntax, {{0}, 1, 7, ""}, "t");
  EXPECT_NE(
      format_for_people(all, all.list[0]).find("     1 |  \xc3\xa9\xc3\xa9 x\n       |     ^\n"),
      std::string::npos)
      << format_for_people(all, all.list[0]);
}

TEST(Diagnostic, LongLinesAreCutOnBothSides) {
  Diagnostics all = with_text(std::string(1u << 20, 'a'));
  all.add(DiagnosticId::syntax, {{0}, 1, 5000, ""}, "t");
  const std::string text = format_for_people(all, all.list[0]);
  EXPECT_LT(text.size(), 500u);
  EXPECT_NE(text.find("...a"), std::string::npos);
  EXPECT_NE(text.find("a...\n"), std::string::npos);
}

TEST(Diagnostic, NothingUnprintableReachesTheTerminal) {
  // also control characters beyond ASCII, and text that runs from right to left
  Diagnostics all = with_text("[\x1b[31m\xff\x7f\xc2\x9b\xe2\x80\xae\xe2\x81\xa6]");
  all.add(DiagnosticId::syntax, {{0}, 1, 3, "/\x1b"}, "bad \x1b[0m \xfe \xc2\x9b \xe2\x80\xae")
      .related.emplace_back(SourceLocation{{0}, 1, 8, ""}, "\x07");
  const std::string text = format_for_people(all, all.list[0]);
  for (char c : text) {
    EXPECT_TRUE(c == '\n' ||
                (static_cast<uint8_t>(c) >= 0x20 && c != 0x7f && static_cast<uint8_t>(c) < 0x80));
  }
}

TEST(Diagnostic, PlacesOutsideTheTextGiveNoExcerptAndNoCrash) {
  for (const SourceLocation& where :
       {SourceLocation{{0}, 9, 1, ""}, SourceLocation{{0}, 1, 99, ""},
        SourceLocation{{7}, 1, 1, ""}, SourceLocation{{}, 0, 0, ""}}) {
    Diagnostics all = with_text("x");
    all.add(DiagnosticId::syntax, where, "t");
    EXPECT_EQ(format_for_people(all, all.list[0]).find('|'), std::string::npos);
  }
}

TEST(Diagnostic, JsonIsValidForAnyText) {
  Diagnostics all = with_text("x");
  all.files[0].name = "quote\".json";
  all.add(DiagnosticId::syntax, {{0}, 1, 1, "/a\\b"}, "line\nbreak \x01 \xff \xc3\xa9")
      .related.emplace_back(SourceLocation{{0}, 1, 1, ""}, "there");
  all.add(DiagnosticId::unknown_key, {{0}, 1, 1, ""}, "second");
  Diagnostics again;
  const auto document = parse_document("out.json", format_as_json(all), again);
  ASSERT_TRUE(document) << testing::all_messages(again);
  const NodeId first = (*document)[document->root()].first_child;
  EXPECT_EQ(document->text(document->find(first, "id")), "D0101");
  EXPECT_EQ(document->text(document->find(first, "file")), "quote\".json");
  EXPECT_EQ(document->text(document->find(first, "text")),
            "line\nbreak \x01 \xef\xbf\xbd \xc3\xa9");
  EXPECT_EQ((*document)[document->find(first, "related")].child_count, 1u);
  EXPECT_EQ(format_as_json(Diagnostics()), "[]");
}

TEST(Diagnostic, ErrorsBeyondTheListLimitStillCount) {
  Diagnostics all;
  for (size_t i = 0; i < limits::diagnostics; ++i)
    all.add(DiagnosticId::too_many_diagnostics, {}, "a mere note");
  EXPECT_FALSE(all.has_errors());
  EXPECT_TRUE(all.full());
  all.add(DiagnosticId::syntax, {}, "an error").suggestion = "kept with it";
  EXPECT_TRUE(all.has_errors());
  EXPECT_EQ(all.list.size(), limits::diagnostics + 1);
  all.add(DiagnosticId::syntax, {}, "another error");
  EXPECT_EQ(all.errors(), 2u);
  // The first error is listed, because a report without one explains nothing.
  EXPECT_EQ(all.list[limits::diagnostics - 1].text, "an error");
  EXPECT_EQ(all.list.back().id, DiagnosticId::too_many_diagnostics);
}

TEST(Diagnostic, EveryIdHasANameAHintAndItsNumberInItsCode) {
  for (const DiagnosticInfo& info : all_diagnostic_infos()) {
    EXPECT_EQ(&diagnostic_info(info.id), &info);
    EXPECT_FALSE(info.hint.empty()) << info.name;
    EXPECT_EQ(info.code, "D0" + std::to_string(static_cast<int>(info.id)));
  }
}

TEST(Diagnostics, SarifHasRulePlaceAndRelatedPlaces) {
  testing::Parsed parsed = testing::parse("{\n  \"\xc3\xa9\": 1, \"\xc3\xa9\": 2 }");
  ASSERT_EQ(parsed.diagnostics.list.size(), 1u);
  parsed.diagnostics.files[0].name = "folder with space/\xc3\xa9#1.json";
  const std::string log = format_as_sarif(parsed.diagnostics, "1.2.3");
  const testing::Parsed read_back = testing::parse(log);
  ASSERT_TRUE(read_back.document) << log;
  for (const char* part :
       {"\"version\": \"2.1.0\"", "\"columnKind\": \"unicodeCodePoints\"", "\"ruleId\": \"D0102\"",
        "\"ruleIndex\": 0", "\"level\": \"error\"", "{ \"startLine\": 2, \"startColumn\": 11 }",
        "{ \"startLine\": 2, \"startColumn\": 3 }", "folder%20with%20space/%C3%A9%231.json",
        "\"text\": \"first given here\""})
    EXPECT_NE(log.find(part), std::string::npos) << part << "\n" << log;
}

TEST(Diagnostics, SarifListsEachRuleOnce_EmptyIsValid) {
  Diagnostics none;
  EXPECT_TRUE(testing::parse(format_as_sarif(none, "0")).document);
  Diagnostics two;
  two.add(DiagnosticId::file_unreadable, {}, "a");
  two.add(DiagnosticId::file_unreadable, {}, "b\xff\x01");
  const std::string log = format_as_sarif(two, "0");
  EXPECT_TRUE(testing::parse(log).document) << log;
  EXPECT_EQ(log.find("\"name\": \"file_unreadable\""), log.rfind("\"name\": \"file_unreadable\""));
}

} // namespace
} // namespace dermis
