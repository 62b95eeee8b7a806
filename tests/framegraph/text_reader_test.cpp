#include "framegraph/text/limits.hpp"
#include "framegraph/text/reader.hpp"
#include "framegraph/text/suggest.hpp"
#include "tests/framegraph/text_support.hpp"

#include <array>

namespace dermis {
namespace {

using testing::all_messages;
using testing::expect_only;
using testing::parse;
using testing::Parsed;

constexpr std::string_view colours[] = {"red", "green", "blue"};

TEST(Reader, ReadsEveryTypeOfValue) {
  Parsed parsed = parse(
      R"({ "$schema": "s", "note": "n", "s": "text", "n": "name_1", "b": true, "i": -3, "x": 2,
    "v": [1, 2.5, -3], "w": "green", "o": {}, "a": [1, 2] })");
  ASSERT_TRUE(parsed.document);
  ObjectReader object(*parsed.document, parsed.document->root(), "thing", parsed.diagnostics);
  EXPECT_EQ(object.string("s"), "text");
  EXPECT_EQ(object.name("n"), "name_1");
  EXPECT_EQ(object.boolean("b"), true);
  EXPECT_EQ(object.integer("i", -3, 5), -3);
  EXPECT_EQ(object.number("x", 0.0, 2.0), 2.0);
  std::array<double, 3> v{};
  EXPECT_TRUE(object.numbers("v", v, -10, 10));
  EXPECT_EQ(v, (std::array<double, 3>{1, 2.5, -3}));
  EXPECT_EQ(object.word("w", colours), 1u);
  EXPECT_TRUE(object.object("o").valid());
  EXPECT_TRUE(object.array("a", 1, 2).valid());
  EXPECT_FALSE(object.integer("absent", 0, 1, Need::optional));
  EXPECT_FALSE(object.has("absent_too"));
  EXPECT_TRUE(object.finish()) << all_messages(parsed.diagnostics);
  EXPECT_TRUE(parsed.diagnostics.list.empty());
}

TEST(Reader, AnUnknownKeyIsRejectedAtTheKeyWithASuggestion) {
  Parsed parsed = parse("{ \"name\": \"x\",\n  \"colur\": \"red\" }");
  ObjectReader object(*parsed.document, parsed.document->root(), "thing", parsed.diagnostics);
  object.string("name");
  object.word("colour", colours, Need::optional);
  EXPECT_FALSE(object.finish());
  expect_only(parsed.diagnostics, DiagnosticId::unknown_key, 2, 3,
              {"thing", "'colur'", "did you mean 'colour'?"});
}

TEST(Reader, AMisspeltRequiredKeyIsOneDiagnostic) {
  Parsed parsed = parse("{ \"cuont\": 1 }");
  ObjectReader object(*parsed.document, parsed.document->root(), "thing", parsed.diagnostics);
  EXPECT_FALSE(object.integer("count", 0, 1));
  EXPECT_FALSE(object.finish());
  expect_only(parsed.diagnostics, DiagnosticId::unknown_key, 1, 3,
              {"thing", "'cuont'", "did you mean 'count'?"});
}

TEST(Reader, OneMisspeltKeyExplainsOneMissingKey) {
  Parsed parsed = parse("{ \"cuont\": 1, \"coutn\": 2, \"shade\": 3 }");
  ObjectReader object(*parsed.document, parsed.document->root(), "thing", parsed.diagnostics);
  object.integer("count", 0, 1);
  object.string("name");
  EXPECT_FALSE(object.finish());
  ASSERT_EQ(parsed.diagnostics.list.size(), 4u) << all_messages(parsed.diagnostics);
  EXPECT_EQ(parsed.diagnostics.list[0].suggestion, "did you mean 'count'?");
  EXPECT_EQ(parsed.diagnostics.list[1].id, DiagnosticId::missing_key); // For 'name'.
  EXPECT_EQ(parsed.diagnostics.list[2].suggestion, "did you mean 'count'?");
  EXPECT_EQ(parsed.diagnostics.list[3].suggestion, ""); // For 'shade'.
}

TEST(Reader, AMissingKeyIsNamedAtTheObject) {
  Parsed parsed = parse("\n { }");
  ObjectReader object(*parsed.document, parsed.document->root(), "thing", parsed.diagnostics);
  EXPECT_FALSE(object.integer("count", 0, 1));
  EXPECT_FALSE(object.finish());
  expect_only(parsed.diagnostics, DiagnosticId::missing_key, 2, 2, {"thing", "'count'"});
}

TEST(Reader, AWrongTypeNamesBothTypes) {
  struct Case {
    std::string_view key, words;
  };
  for (const Case& one :
       {Case{"s", "a string; found an integer"}, Case{"b", "a boolean; found an integer"},
        Case{"o", "an object; found an integer"}, Case{"a", "an array; found an integer"}}) {
    Parsed parsed = parse("{ \"k\": 1 }");
    ObjectReader object(*parsed.document, parsed.document->root(), "thing", parsed.diagnostics);
    if (one.key == "s") object.string("k");
    if (one.key == "b") object.boolean("k");
    if (one.key == "o") object.object("k");
    if (one.key == "a") object.array("k", 0, 1);
    EXPECT_FALSE(object.finish());
    expect_only(parsed.diagnostics, DiagnosticId::wrong_type, 1, 8,
                {"'k' of thing", std::string(one.words)});
  }
  Parsed parsed = parse("{ \"k\": 1.0 }");
  ObjectReader object(*parsed.document, parsed.document->root(), "thing", parsed.diagnostics);
  EXPECT_FALSE(object.integer("k", 0, 1));
  expect_only(parsed.diagnostics, DiagnosticId::wrong_type, 1, 8, {"an integer; found a number"});
}

TEST(Reader, ValuesOutOfRangeNameTheRange) {
  Parsed integer = parse("{ \"k\": 9 }");
  EXPECT_FALSE(
      ObjectReader(*integer.document, {0}, "thing", integer.diagnostics).integer("k", 1, 8));
  expect_only(integer.diagnostics, DiagnosticId::out_of_range, 1, 8, {"9", "1 .. 8"});
  Parsed number = parse("{ \"k\": 0.5 }");
  EXPECT_FALSE(
      ObjectReader(*number.document, {0}, "thing", number.diagnostics).number("k", 1.0, 8.0));
  expect_only(number.diagnostics, DiagnosticId::out_of_range, 1, 8, {"0.5"});
  Parsed list = parse("{ \"k\": [1, 2,\n 30] }");
  std::array<double, 3> out{};
  EXPECT_FALSE(
      ObjectReader(*list.document, {0}, "thing", list.diagnostics).numbers("k", out, 0, 10));
  expect_only(list.diagnostics, DiagnosticId::out_of_range, 2, 2, {"number 3 of 'k' of thing"});
  EXPECT_EQ(out[0], 0.0) << "untouched on error";
}

TEST(Reader, ArraysOfWrongLengthAreRejected) {
  Parsed numbers = parse("{ \"k\": [1, 2] }");
  std::array<double, 3> out{};
  EXPECT_FALSE(
      ObjectReader(*numbers.document, {0}, "thing", numbers.diagnostics).numbers("k", out, 0, 10));
  expect_only(numbers.diagnostics, DiagnosticId::wrong_type, 1, 8, {"3 numbers", "2 values"});
  Parsed few = parse("{ \"k\": [] }");
  EXPECT_FALSE(ObjectReader(*few.document, {0}, "thing", few.diagnostics).array("k", 1, 2).valid());
  expect_only(few.diagnostics, DiagnosticId::out_of_range, 1, 8, {"1 .. 2"});
  Parsed many = parse("{ \"k\": [1, 2, 3] }");
  EXPECT_FALSE(
      ObjectReader(*many.document, {0}, "thing", many.diagnostics).array("k", 1, 2).valid());
  expect_only(many.diagnostics, DiagnosticId::limit_exceeded, 1, 8, {"3 entries"});
}

TEST(Reader, AnUnlistedWordIsRejectedWithTheListAndASuggestion) {
  Parsed parsed = parse("{ \"k\": \"grean\" }");
  EXPECT_FALSE(ObjectReader(*parsed.document, {0}, "thing", parsed.diagnostics).word("k", colours));
  expect_only(parsed.diagnostics, DiagnosticId::invalid_value, 1, 8,
              {"'grean'", "'red', 'green' or 'blue'", "did you mean 'green'?"});
}

TEST(Reader, NamesAreIdentifiersOfLimitedLength) {
  for (const std::string& bad : {std::string(), std::string("1a"), std::string("a b"),
                                 std::string("a-b"), std::string("é")}) {
    Parsed parsed = parse("{ \"k\": \"" + bad + "\" }");
    EXPECT_FALSE(ObjectReader(*parsed.document, {0}, "thing", parsed.diagnostics).name("k"));
    expect_only(parsed.diagnostics, DiagnosticId::bad_name, 1, 8);
  }
  Parsed parsed = parse("{ \"k\": \"" + std::string(limits::name_bytes + 1, 'a') + "\" }");
  EXPECT_FALSE(ObjectReader(*parsed.document, {0}, "thing", parsed.diagnostics).name("k"));
  expect_only(parsed.diagnostics, DiagnosticId::limit_exceeded, 1, 8);
}

TEST(Reader, NotesAreStrings_SchemaOnlyAtTheRoot) {
  Parsed note = parse("{ \"note\": 1 }");
  EXPECT_FALSE(ObjectReader(*note.document, {0}, "thing", note.diagnostics).finish());
  expect_only(note.diagnostics, DiagnosticId::wrong_type, 1, 11);
  Parsed inner = parse("{ \"o\": { \"$schema\": \"x\" } }");
  EXPECT_FALSE(ObjectReader(*inner.document, {1}, "inner", inner.diagnostics).finish());
  expect_only(inner.diagnostics, DiagnosticId::unknown_key, 1, 10);
}

TEST(Reader, TheVersionKeyIsRequiredAndChecked) {
  Parsed good = parse("{ \"v\": 1 }");
  EXPECT_TRUE(check_version(*good.document, "v", 1, good.diagnostics));
  Parsed absent = parse("{ }");
  EXPECT_FALSE(check_version(*absent.document, "v", 1, absent.diagnostics));
  expect_only(absent.diagnostics, DiagnosticId::missing_key, 1, 1, {"\"v\": 1"});
  Parsed misspelt = parse("{ \"vresion\": 1 }");
  EXPECT_FALSE(check_version(*misspelt.document, "version", 1, misspelt.diagnostics));
  expect_only(misspelt.diagnostics, DiagnosticId::unknown_key, 1, 3,
              {"\"version\": 1", "did you mean 'version'?"});
  Parsed other = parse("{ \"name\": \"n\",\n  \"dermis_profile\": 1 }");
  EXPECT_FALSE(check_version(*other.document, "dermis", 1, other.diagnostics));
  expect_only(other.diagnostics, DiagnosticId::other_kind_of_file, 2, 3,
              {"'dermis_profile'", "'dermis'"});
  Parsed graph = parse("{ \"dermis\": 2 }");
  EXPECT_FALSE(check_version(*graph.document, "dermis_profile", 1, graph.diagnostics));
  expect_only(graph.diagnostics, DiagnosticId::other_kind_of_file, 1, 3,
              {"'dermis'", "'dermis_profile'"});
  Parsed newer = parse("{ \"v\": 2 }");
  EXPECT_FALSE(check_version(*newer.document, "v", 1, newer.diagnostics));
  expect_only(newer.diagnostics, DiagnosticId::unsupported_version, 1, 8, {"version 1"});
  Parsed array = parse("[]");
  EXPECT_FALSE(check_version(*array.document, "v", 1, array.diagnostics));
  expect_only(array.diagnostics, DiagnosticId::wrong_type, 1, 1);
}

TEST(Reader, ManyUnknownKeysGiveBoundedDiagnostics) {
  std::string text = "{\"k0\":0";
  for (size_t i = 1; i < 200000; ++i)
    text += ",\"k" + std::to_string(i) + "\":0";
  Parsed parsed = parse(text + "}");
  ASSERT_TRUE(parsed.document) << all_messages(parsed.diagnostics);
  EXPECT_FALSE(ObjectReader(*parsed.document, {0}, "thing", parsed.diagnostics).finish());
  EXPECT_EQ(parsed.diagnostics.list.size(), limits::diagnostics + 1);
}

TEST(Suggest, DistanceCountsEditsAndSwaps) {
  EXPECT_EQ(edit_distance("size", "size", 9), 0u);
  EXPECT_EQ(edit_distance("size", "Size", 9), 0u);
  EXPECT_EQ(edit_distance("size", "szie", 9), 1u);
  EXPECT_EQ(edit_distance("size", "sizes", 9), 1u);
  EXPECT_EQ(edit_distance("", "abc", 9), 3u);
  EXPECT_EQ(edit_distance("kitten", "sitting", 9), 3u);
  EXPECT_EQ(edit_distance("kitten", "sitting", 1), 2u) << "limit + 1";
}

TEST(Suggest, NothingIsSuggestedForAnUnrelatedWord) {
  constexpr std::string_view words[] = {"format", "size"};
  EXPECT_EQ(nearest("fromat", words), "format");
  EXPECT_EQ(nearest("quaternion", words), "");
  EXPECT_EQ(nearest("xy", words), "");
}

} // namespace
} // namespace dermis
