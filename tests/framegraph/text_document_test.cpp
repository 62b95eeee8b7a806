#include "framegraph/text/document.hpp"

#include "framegraph/text/limits.hpp"
#include "tests/framegraph/text_support.hpp"

#include <cstdio>
#include <filesystem>
#include <fstream>

namespace dermis {
namespace {

using testing::all_messages;
using testing::expect_only;
using testing::expect_rejected;
using testing::parse;
using testing::Parsed;

std::string place(const SourceLocation& where) {
  return std::to_string(where.line) + ":" + std::to_string(where.column);
}

TEST(Document, EveryValueAndKeyKnowsLineColumnAndPointer) {
  const Parsed parsed =
      parse("{ // first\n  \"a/b\": [1, -2.5, true,\n\tnull],\r\n \"c~\" :{\"d\":\"x\"} }");
  ASSERT_TRUE(parsed.document) << all_messages(parsed.diagnostics);
  const Document& document = *parsed.document;
  ASSERT_EQ(document.nodes.size(), 8u);
  EXPECT_EQ(place(document.where(document.root())), "1:1");
  EXPECT_EQ(document.where(document.root()).pointer, "");
  const NodeId list = document.find(document.root(), "a/b");
  ASSERT_TRUE(list.valid());
  EXPECT_EQ(place(document.where(list)), "2:10");
  EXPECT_EQ(place(document.where_key(list)), "2:3");
  EXPECT_EQ(document.pointer(list), "/a~1b");
  EXPECT_EQ(document[list].child_count, 4u);
  const std::vector<std::string> places = {"2:11", "2:14", "2:20", "3:2"};
  size_t i = 0;
  for (NodeId child = document[list].first_child; child.valid();
       child = document[child].next, ++i) {
    EXPECT_EQ(place(document.where(child)), places[i]);
    EXPECT_EQ(document.pointer(child), "/a~1b/" + std::to_string(i));
  }
  const NodeId object = document.find(document.root(), "c~");
  ASSERT_TRUE(object.valid());
  EXPECT_EQ(place(document.where_key(object)), "4:2");
  EXPECT_EQ(place(document.where(object)), "4:8");
  const NodeId inner = document.find(object, "d");
  EXPECT_EQ(document.pointer(inner), "/c~0/d");
  EXPECT_EQ(place(document.where(inner)), "4:13");
  EXPECT_EQ(document.text(inner), "x");
}

TEST(Document, ValuesAreReadExactly) {
  const Parsed parsed = parse(
      "[9223372036854775807, -9223372036854775808, 0.1, 1e308, 5e-324, \"\\u00e9\\n\\\"\", false]");
  ASSERT_TRUE(parsed.document) << all_messages(parsed.diagnostics);
  const Document& d = *parsed.document;
  EXPECT_EQ(d[{1}].integer, INT64_MAX);
  EXPECT_EQ(d[{2}].integer, INT64_MIN);
  EXPECT_EQ(d[{3}].real, 0.1);
  EXPECT_EQ(d[{4}].real, 1e308);
  EXPECT_EQ(d[{5}].real, 5e-324);
  EXPECT_EQ(d.text({6}), "\xc3\xa9\n\"");
  EXPECT_EQ(d[{7}].kind, NodeKind::boolean);
  EXPECT_EQ(d[{7}].integer, 0);
}

TEST(Document, ExtraAndMissingCommasAreNamed) {
  for (const char* text : {"{ \"a\": 1, }", "[1, ]", "[[1], ]"}) {
    const Parsed parsed = parse(text);
    ASSERT_EQ(parsed.diagnostics.list.size(), 1u) << text;
    EXPECT_THAT(parsed.diagnostics.list[0].text, HasSubstr("remove the comma before it"));
  }
  for (const char* text : {"{ \"a\": 1 \"b\": 2 }", "[1 2]", "[\"a\" \"b\"]", "[{} {}]",
                           "{ \"a\": 0.5\"b\": 2 }", "[0.5[", "[0.5{", "[5\"b\"]", "[1e3\"b\"]"}) {
    const Parsed parsed = parse(text);
    ASSERT_EQ(parsed.diagnostics.list.size(), 1u) << text;
    EXPECT_THAT(parsed.diagnostics.list[0].text, HasSubstr("add a comma before it"));
  }
  for (const char* text : {"{ \"a\": ] }", "{ \"a\" 1 }", "[1", "{", "[1}", "{ 1 }", "[}"}) {
    const Parsed parsed = parse(text);
    ASSERT_EQ(parsed.diagnostics.list.size(), 1u) << text;
    EXPECT_THAT(parsed.diagnostics.list[0].text, Not(HasSubstr("comma"))) << text;
  }
}

TEST(Document, ByteOrderMarkIsNotPartOfTheFirstLine) {
  const Parsed parsed = parse("\xef\xbb\xbf[7]");
  ASSERT_TRUE(parsed.document) << all_messages(parsed.diagnostics);
  EXPECT_EQ(place(parsed.document->where({1})), "1:2");
}

TEST(Document, SecondByteOrderMarkIsRejected) {
  expect_rejected("\xef\xbb\xbf\xef\xbb\xbf[7]", DiagnosticId::syntax, 1, 1, {"byte order mark"});
  expect_rejected("[\xef\xbb\xbf 7]", DiagnosticId::syntax, 1, 2);
}

TEST(Document, APlaceInsideAStringIsFoundThroughEscapes) {
  const Parsed parsed = parse("[\n  \"a\\u00e9\\n\\ud83d\\ude00b\"]");
  ASSERT_TRUE(parsed.document) << all_messages(parsed.diagnostics);
  const Document& d = *parsed.document;
  ASSERT_EQ(d.text({1}), "a\xc3\xa9\n\xf0\x9f\x98\x80"
                         "b");
  EXPECT_EQ(place(where_in_string(d, {1}, 0, parsed.diagnostics)), "2:4"); // Character "a".
  // Character "\u00e9": two bytes.
  EXPECT_EQ(place(where_in_string(d, {1}, 1, parsed.diagnostics)), "2:5");
  // Character "
  // ".
  EXPECT_EQ(place(where_in_string(d, {1}, 3, parsed.diagnostics)), "2:11");
  // A surrogate pair: four bytes.
  EXPECT_EQ(place(where_in_string(d, {1}, 4, parsed.diagnostics)), "2:13");
  EXPECT_EQ(place(where_in_string(d, {1}, 8, parsed.diagnostics)), "2:25"); // Character "b".
}

TEST(Document, DuplicateKeysAreRejectedWithBothLocations) {
  const Parsed parsed = parse("{ \"a\": 1,\n  \"b\": 2,\n  \"a\": 3 }");
  EXPECT_FALSE(parsed.document);
  expect_only(parsed.diagnostics, DiagnosticId::duplicate_key, 3, 3, {"'a'"});
  ASSERT_EQ(parsed.diagnostics.list[0].related.size(), 1u);
  EXPECT_EQ(place(parsed.diagnostics.list[0].related[0].first), "1:3");
}

TEST(Document, RepeatedKeysAreReportedInTextOrder) {
  const Parsed parsed = parse("{\"z\":1,\"a\":1,\"z\":1,\"a\":1,\"z\":1}");
  ASSERT_EQ(parsed.diagnostics.list.size(), 3u);
  EXPECT_EQ(place(parsed.diagnostics.list[0].where), "1:14");
  EXPECT_EQ(place(parsed.diagnostics.list[1].where), "1:20");
  EXPECT_EQ(place(parsed.diagnostics.list[2].where), "1:26");
  EXPECT_EQ(place(parsed.diagnostics.list[2].related[0].first), "1:2");
}

TEST(Document, TheSameKeyInDifferentObjectsIsNoDuplicate) {
  EXPECT_TRUE(parse("{\"a\":{\"a\":1},\"b\":{\"a\":1}}").document);
}

struct Malformed {
  const char* text;
  uint32_t line, column;
};

class MalformedText : public ::testing::TestWithParam<Malformed> {};

TEST_P(MalformedText, IsRejectedWhereItGoesWrong) {
  expect_rejected(GetParam().text, DiagnosticId::syntax, GetParam().line, GetParam().column);
}

INSTANTIATE_TEST_SUITE_P(
    Document, MalformedText,
    ::testing::Values(Malformed{"", 1, 1}, Malformed{"{", 1, 2}, Malformed{"[1,\n 2,, 3]", 2, 4},
                      Malformed{"[1 2]", 1, 4}, Malformed{"[12,\n34 56]", 2, 4},
                      Malformed{"{\"a\" 1}", 1, 6}, Malformed{"{\"a\": }", 1, 7},
                      Malformed{"{a: 1}", 1, 2}, Malformed{"[1] x", 1, 5}, Malformed{"[tru]", 1, 5},
                      Malformed{"[\"a\\q\"]", 1, 5}, Malformed{"[\"a\nb\"]", 1, 4},
                      Malformed{"[1,]", 1, 4}, Malformed{"[01]", 1, 2},
                      Malformed{"[\"\\ud800\"]", 1, 9}, Malformed{"[1, /* no */ 2]", 1, 6},
                      Malformed{"[NaN]", 1, 2}, Malformed{"[\"a\\u0000b\"]", 1, 2},
                      Malformed{"{\"\\u0000\": 1}", 1, 2}));

TEST(Document, ErrorsInValuesHaveTheValuesPointer) {
  using namespace std::string_literals;
  const std::string number(limits::number_bytes + 1, '1'), text(limits::string_bytes + 1, 'x');
  std::string nested = "{ \"a\": ", zeros;
  for (size_t i = 1; i < limits::nesting; ++i)
    zeros += "/0";
  const struct {
    std::string text, pointer;
  } cases[] = {
      {R"({ "a": [1, 99999999999999999999] })", "/a/1"},
      {R"({ "a/b": { "c": 99999999999999999999 } })", "/a~1b/c"},
      {R"({ "a": 1, "b~": "\u0000" })", "/b~0"},
      {R"({ "a": { "\u0000": 1 } })", "/a"},
      {R"({ "a": [1, 1e999] })", "/a/1"},
      {R"({ "a": 1, "b": nul })", "/b"},
      {R"({ "a": { "b": 1 "c": 2 } })", "/a"},
      {R"({ "a": [1, ] })", "/a"},
      {"{ \"a\": { \"b\": 1, \0 } }"s, "/a"},
      {R"({ "a": { "b": /* no */ 1 } })", "/a/b"},
      {R"({ "a": [1, /* no */ 1] })", "/a"},
      {R"({ "a": [1, )" + number + "] }", "/a/1"},
      {R"({ "a": { "b": ")" + text + "\" } }", "/a/b"},
      {R"({ "a": { ")" + text + "\": 1 } }", "/a"},
      {nested + std::string(limits::nesting, '['), "/a" + zeros},
      {R"({ "a": 1, "a": 2 })", "/a"},
  };
  for (const auto& [text, pointer] : cases) {
    const Parsed parsed = parse(text);
    ASSERT_EQ(parsed.diagnostics.list.size(), 1u) << text.substr(0, 80);
    EXPECT_EQ(parsed.diagnostics.list[0].where.pointer, pointer) << text.substr(0, 80);
  }
}

TEST(Document, TextAfterANulByteIsNotIgnored) {
  using namespace std::string_literals;
  expect_rejected("[1]\n\0 rubbish"s, DiagnosticId::syntax, 2, 1, {"NUL"});
  expect_rejected("[1] // \0\n]"s, DiagnosticId::syntax, 1, 8, {"NUL"});
}

TEST(Document, IntegersThatWouldBecomeDoublesAreRejected) {
  for (const char* text : {"[1,\n 9223372036854775808]", "[1,\n -9223372036854775809]",
                           "[1,\n 99999999999999999999]"}) {
    expect_rejected(text, DiagnosticId::integer_precision, 2, 2, {"64"});
  }
}

TEST(Document, NumbersBeyondDoubleAreRejected) {
  expect_rejected("{ \"x\": 1e999 }", DiagnosticId::out_of_range, 1, 8, {"1e999"});
}

TEST(Document, IllFormedUtf8IsRejectedAtItsPlace) {
  for (const char* bytes :
       {"\xff", "\xc0\xaf", "\xe0\x80\x80", "\xed\xa0\x80", "\xf5\x80\x80\x80", "\xc3"}) {
    expect_rejected(std::string("[\n\"ab") + bytes + "\"]", DiagnosticId::invalid_utf8, 2, 4);
  }
  expect_rejected("[] // \x80", DiagnosticId::invalid_utf8, 1, 7);
}

TEST(Document, ATextBeyondTheFileLimitIsRejected) {
  expect_rejected(std::string(20u << 20, ' '), DiagnosticId::limit_exceeded, 0, 0, {"16777216"});
}

TEST(Document, AFileBeyondTheLimitIsRejectedBeforeItIsRead) {
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / "dermis_text_document_test_large.json";
  std::ofstream(path).put('[');
  std::filesystem::resize_file(path, 1ull << 34); // Sparse: reading it would take 16 GiB.
  Diagnostics diagnostics;
  EXPECT_FALSE(read_document(path.string(), diagnostics));
  std::filesystem::remove(path);
  expect_only(diagnostics, DiagnosticId::limit_exceeded, 0, 0, {"17179869184"});
}

TEST(Document, UnreadableFileIsRejected) {
  Diagnostics missing;
  EXPECT_FALSE(read_document("/nonexistent/graph.json", missing));
  expect_only(missing, DiagnosticId::file_unreadable, 0, 0,
              {"/nonexistent/graph.json", "does not exist"});
  Diagnostics folder;
  EXPECT_FALSE(read_document("/", folder));
  expect_only(folder, DiagnosticId::file_unreadable, 0, 0, {"not a regular file"});
}

TEST(Document, NestingBeyondTheLimitIsRejectedAtTheBracket) {
  const size_t maximum = limits::nesting;
  EXPECT_TRUE(parse(std::string(maximum, '[') + std::string(maximum, ']')).document);
  expect_rejected(std::string(1000000, '['), DiagnosticId::limit_exceeded, 1,
                  static_cast<uint32_t>(maximum + 1), {"nested"});
}

TEST(Document, StringsBeyondTheLimitAreRejectedAtTheirStart) {
  const size_t maximum = limits::string_bytes;
  EXPECT_TRUE(parse("[\"" + std::string(maximum, 'x') + "\"]").document);
  for (const std::string& text :
       {"[\"" + std::string(maximum + 1, 'x') + "\"]", "[\"" + std::string(8u << 20, 'x'),
        "{\"" + std::string(maximum + 1, 'x') + "\": 1}"}) {
    expect_rejected(text, DiagnosticId::limit_exceeded, 1, 2);
  }
}

TEST(Document, KeysAndNumbersBeyondTheirLimitAreRejected) {
  expect_rejected("{\"" + std::string(limits::key_bytes + 1, 'k') + "\": 1}",
                  DiagnosticId::limit_exceeded, 1, 2, {"key"});
  EXPECT_TRUE(parse("{\"" + std::string(limits::key_bytes, 'k') + "\": 1}").document);
  expect_rejected("[0." + std::string(1u << 20, '1') + "]", DiagnosticId::limit_exceeded, 1, 2);
}

TEST(Document, MoreValuesThanTheLimitAreRejected) {
  std::string text = "[0";
  for (size_t i = 0; i < limits::nodes; ++i)
    text += ",0";
  const Parsed parsed = parse(text + "]");
  EXPECT_FALSE(parsed.document);
  // The root is one value, so entry number `nodes` (counted from 1) is the first beyond the limit.
  // An entry is two bytes.
  expect_only(parsed.diagnostics, DiagnosticId::limit_exceeded, 1,
              static_cast<uint32_t>(2 * limits::nodes));
}

TEST(Document, ManyRepeatedKeysGiveBoundedDiagnostics) {
  std::string text = "{\"k\":0";
  for (size_t i = 0; i + 3 < limits::nodes; ++i)
    text += ",\"k\":0";
  const Parsed parsed = parse(text + "}");
  EXPECT_FALSE(parsed.document);
  EXPECT_EQ(parsed.diagnostics.list.size(), limits::diagnostics + 1);
  EXPECT_EQ(parsed.diagnostics.list.back().id, DiagnosticId::too_many_diagnostics);
}

// Every prefix and every single-byte change of a valid text is accepted or rejected with a
// diagnostic, without a crash.
TEST(Document, DamagedTextsAreAcceptedOrExplained) {
  const std::string whole =
      "{ \"a\": [1, -2.5e3, \"x\\u00e9\\n\", true, null], // c\n \"b\": { \"c\": {} } }";
  const auto check = [](const std::string& text) {
    const Parsed parsed = parse(text);
    EXPECT_EQ(parsed.document.has_value(), !parsed.diagnostics.has_errors()) << text;
    for (const Diagnostic& one : parsed.diagnostics.list)
      EXPECT_FALSE(format_for_people(parsed.diagnostics, one).empty());
  };
  for (size_t length = 0; length < whole.size(); ++length)
    check(whole.substr(0, length));
  for (size_t at = 0; at < whole.size(); ++at) {
    for (int byte = 0; byte < 256; byte += 3) {
      std::string damaged = whole;
      damaged[at] = static_cast<char>(byte);
      check(damaged);
    }
  }
}

} // namespace
} // namespace dermis
