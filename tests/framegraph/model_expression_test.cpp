#include "framegraph/model/expression.hpp"
#include "framegraph/model/splitmix.hpp"
#include "framegraph/text/limits.hpp"
#include "tests/framegraph/text_support.hpp"

namespace dermis {
namespace {

using testing::all_messages;
using testing::expect_only;

// Declares the settings flag (true), count (16), scale (1.5), mode (enum a b c: b) and other (enum
// x y: x).
struct Fixture {
  Graph graph;
  Diagnostics diagnostics;
  std::vector<SettingValue> values;

  Fixture() {
    add("flag", {SettingType::boolean, 1, 0.0});
    add("count", {SettingType::integer, 16, 0.0});
    add("scale", {SettingType::real, 0, 1.5});
    add("mode", {SettingType::choice, 1, 0.0}, {"a", "b", "c"});
    add("other", {SettingType::enumeration, 0, 0.0}, {"x", "y"});
  }
  void add(const char* name, SettingValue value, std::vector<std::string> options = {}) {
    SettingDeclaration declared;
    declared.name = name;
    declared.type = value.type;
    declared.options = std::move(options);
    graph.settings.push_back(std::move(declared));
    values.push_back(value);
  }
  ExpressionId parse(const std::string& text, std::vector<bool> broken = std::vector<bool>(5)) {
    const auto document = parse_document("e.json", "[\n\"" + text + "\"]", diagnostics);
    EXPECT_TRUE(document) << text;
    return document ? parse_expression(*document, {1}, "'when'", graph, broken, diagnostics)
                    : ExpressionId();
  }
};

struct Case {
  const char* text;
  bool value;
};

TEST(Expression, EvaluatesWithTheStatedPrecedence) {
  for (const Case& one :
       {Case{"flag", true}, Case{"not flag", false}, Case{"not not flag", true}, Case{"true", true},
        Case{"false", false}, Case{"count == 16", true}, Case{"count != 16", false},
        Case{"count < 16", false}, Case{"count <= 16", true}, Case{"count > 15.5", true},
        Case{"16 >= count", true}, Case{"count > -1", true}, Case{"scale == 1.5", true},
        Case{"scale < 2", true}, Case{"scale > 1e0", true}, Case{"mode == 'b'", true},
        Case{"'b' == mode", true}, Case{"mode != 'b'", false}, Case{"mode in ['a', 'c']", false},
        Case{"mode in ['b']", true}, Case{"mode not in ['a', 'c']", true},
        Case{"count in [1, 16]", true}, Case{"count in [1, 16.5]", false},
        Case{"flag in [false]", false}, Case{"flag == true", true},
        Case{"flag == (count == 16)", true},
        Case{"mode == 'a' and count == 1 or flag", true}, // `and` binds more tightly than `or`.
        Case{"mode == 'a' and (count == 1 or flag)", false}, Case{"flag or flag and false", true},
        // `not` binds more tightly than `and`, but less tightly than `==`.
        Case{"not mode == 'a' and flag", true}, Case{"  mode\\tin\\n[ 'a' ,'b']  ", true},
        Case{"mode == mode", true}, Case{"count == 9223372036854775807", false}}) {
    Fixture fixture;
    const ExpressionId id = fixture.parse(one.text);
    ASSERT_TRUE(id.valid()) << one.text << "\n" << all_messages(fixture.diagnostics);
    EXPECT_EQ(evaluate(fixture.graph, id, fixture.values), one.value) << one.text;
    for (uint32_t i = 0; i < fixture.graph.expressions.size(); ++i) {
      const Expression& node = fixture.graph.expressions[i];
      EXPECT_TRUE(!node.left.valid() || node.left.value < i)
          << "children are stored before parents";
      EXPECT_TRUE(!node.right.valid() || node.right.value < i);
    }
  }
}

struct Wrong {
  const char* text;
  DiagnosticId id;
  uint32_t at; // Byte of the expression, from 0.
  const char* word;
};

TEST(Expression, ErrorsPointIntoTheString) {
  using Id = DiagnosticId;
  for (const Wrong& one : {
           Wrong{"", Id::bad_expression, 0, "the end"},
           Wrong{"flag and", Id::bad_expression, 8, "the end"},
           Wrong{"flag flag", Id::bad_expression, 5, "'flag'"},
           Wrong{"(flag", Id::bad_expression, 5, "expected ')'"},
           Wrong{"flag)", Id::bad_expression, 4, "')'"},
           Wrong{"count = 16", Id::bad_expression, 6, "unknown operator '='; expected =="},
           Wrong{"count === 16", Id::bad_expression, 8, "unknown operator '==='"},
           Wrong{"count <> 16", Id::bad_expression, 7, "unknown operator '<>'"},
           Wrong{"count => 16", Id::bad_expression, 6, "did you mean '>='?"},
           Wrong{"flag && flag", Id::bad_expression, 5, "did you mean 'and'?"},
           Wrong{"flag || flag", Id::bad_expression, 5, "unknown operator '||'"},
           Wrong{"!flag", Id::bad_expression, 0, "did you mean 'not'?"},
           Wrong{"flag AND flag", Id::bad_expression, 5, "did you mean 'and'?"},
           Wrong{"NOT flag", Id::bad_expression, 0, "did you mean 'not'?"},
           Wrong{"flag xor flag", Id::bad_expression, 5, "unknown operator 'xor'"},
           Wrong{"flag is true", Id::bad_expression, 5, "did you mean '=='?"},
           Wrong{"count + 1 == 2", Id::bad_expression, 6, "unknown operator '+'"},
           Wrong{"count -1 == 2", Id::bad_expression, 6, "unknown operator '-'"},
           Wrong{"count % 2 == 0", Id::bad_expression, 6, "unknown operator '%'"},
           Wrong{"mode in 'a'", Id::bad_expression, 8, "expected '['"},
           Wrong{"mode in []", Id::bad_expression, 9, "']'"},
           Wrong{"mode in ['a' 'b']", Id::bad_expression, 13, "expected ',' or ']'"},
           Wrong{"mode not ['a']", Id::bad_expression, 9, "expected 'in'"},
           Wrong{"mode == 'a", Id::bad_expression, 8, "''a'"},
           Wrong{"count == 12x", Id::bad_expression, 9, "'12x'"},
           Wrong{"count == 99999999999999999999", Id::bad_expression, 9, "'99999999999999999999'"},
           Wrong{"count == 1e999", Id::bad_expression, 9, "'1e999'"},
           Wrong{"cuont == 1", Id::unknown_setting, 0, "did you mean 'count'?"},
           Wrong{"mode == 'd'", Id::expression_type, 8, "'a', 'b' or 'c'"},
           Wrong{"mode in ['a', 'd']", Id::expression_type, 14,
                 "'d' is not an option of the setting 'mode'"},
           Wrong{"count == 'a'", Id::expression_type, 9,
                 "a number is compared with a quoted option"},
           Wrong{"count == flag", Id::expression_type, 9, "a number is compared with a boolean"},
           Wrong{"'a' == 'a'", Id::expression_type, 7, "a quoted option"},
           Wrong{"'a' in ['a']", Id::expression_type, 0, "left side of 'in'"},
           Wrong{"flag < true", Id::expression_type, 5, "cannot be ordered"},
           Wrong{"mode < 'b'", Id::expression_type, 5, "cannot be ordered"},
           Wrong{"mode == other", Id::expression_type, 8, "different options"},
           Wrong{"count", Id::expression_type, 0, "a number is used where"},
           Wrong{"'a'", Id::expression_type, 0, "a quoted option is used where"},
           Wrong{"flag and count", Id::expression_type, 9, "a number is used where"},
           Wrong{"not mode", Id::expression_type, 4, "an option is used where"},
           Wrong{"flag < count < 3", Id::expression_type, 7, "compared"},
       }) {
    Fixture fixture;
    EXPECT_FALSE(fixture.parse(one.text).valid()) << one.text;
    // The expression starts on line 2, after the opening quote in column 1.
    expect_only(fixture.diagnostics, one.id, 2, one.at + 2, {one.word});
    EXPECT_TRUE(fixture.graph.expressions.empty()) << "no partial expression remains";
  }
}

TEST(Expression, BrokenSettingsGiveNoSecondError) {
  Fixture fixture;
  EXPECT_FALSE(fixture.parse("mode == 'd' and flag", {false, false, false, true, false}).valid());
  EXPECT_TRUE(fixture.diagnostics.list.empty());
}

TEST(Expression, NestingAndLengthAreBounded) {
  const size_t maximum = limits::expression_nesting;
  Fixture deep;
  EXPECT_TRUE(deep.parse(std::string(maximum, '(') + "flag" + std::string(maximum, ')')).valid())
      << all_messages(deep.diagnostics);
  EXPECT_FALSE(
      deep.parse(std::string(maximum + 1, '(') + "flag" + std::string(maximum + 1, ')')).valid());
  expect_only(deep.diagnostics, DiagnosticId::limit_exceeded, 2,
              static_cast<uint32_t>(maximum + 2));
  Fixture negated;
  std::string many;
  for (size_t i = 0; i <= maximum; ++i)
    many += "not ";
  EXPECT_FALSE(negated.parse(many + "flag").valid());
  expect_only(negated.diagnostics, DiagnosticId::limit_exceeded, 2,
              static_cast<uint32_t>(4 * maximum + 2));
  Fixture long_one;
  std::string text = "flag";
  while (text.size() <= limits::expression_bytes)
    text += " and flag";
  EXPECT_FALSE(long_one.parse(text).valid());
  expect_only(long_one.diagnostics, DiagnosticId::limit_exceeded, 2, 1);
}

// Random strings of the language's tokens are parsed and evaluated, or rejected with one error.
TEST(Expression, EveryStringIsParsedOrExplained) {
  const char* words[] = {"flag", "count", "mode", "'a'", "'q'", "1",  "2.5", "and",
                         "or",   "not",   "in",   "[",   "]",   "(",  ")",   ",",
                         "==",   "<",     ">=",   "!",   "'",   "zzz"};
  uint32_t state = 1; // Linear congruential generator with the constants of Numerical Recipes.
  const auto next = [&] { return (state = state * 1664525u + 1013904223u) >> 16; };
  for (int round = 0; round < 20000; ++round) {
    std::string text;
    for (uint32_t length = next() % 9; length > 0; --length)
      text += std::string(words[next() % std::size(words)]) + " ";
    Fixture fixture;
    const ExpressionId id = fixture.parse(text);
    EXPECT_EQ(fixture.diagnostics.list.size(), id.valid() ? 0u : 1u)
        << text << "\n"
        << all_messages(fixture.diagnostics);
    if (id.valid()) evaluate(fixture.graph, id, fixture.values);
  }
}

// Compares with an exhaustive search over a few values whether two conditions can hold together.
TEST(Expression, Conditions_CompatibilityMatchesExhaustiveSearch) {
  Fixture fixture;
  fixture.graph.settings[1].maximum = 4;
  fixture.graph.settings[2].maximum = 2;
  std::vector<ExpressionId> all;
  for (const char* text : {"flag",
                           "not flag",
                           "count > 1",
                           "count <= 1",
                           "count == 2",
                           "count in [1, 3]",
                           "count > 1.5",
                           "scale < 0.5",
                           "scale >= 0.5",
                           "scale == 1",
                           "scale > 1.5",
                           "count < scale",
                           "scale == count",
                           "mode == 'a'",
                           "mode in ['b', 'c']",
                           "other != 'x'",
                           "flag and count > 3",
                           "flag or scale > 1",
                           "not (mode == 'a' or count < 2)",
                           "count > 3 and scale > 1",
                           "scale > 1 and scale < 1.5"}) {
    all.push_back(fixture.parse(text));
    ASSERT_TRUE(all.back().valid()) << text << all_messages(fixture.diagnostics);
  }
  const auto brute_force = [&](std::span<const Condition> conditions) {
    for (int64_t i = 0; i < 2 * 5 * 9 * 3 * 2; ++i) {
      const std::vector<SettingValue> values{
          {SettingType::boolean, i % 2, 0.0},
          {SettingType::integer, i / 2 % 5, 0.0},
          {SettingType::real, 0, static_cast<double>(i / 10 % 9) / 4},
          {SettingType::choice, i / 90 % 3, 0.0},
          {SettingType::enumeration, i / 270, 0.0}};
      if (std::all_of(conditions.begin(), conditions.end(), [&](const Condition& one) {
            return evaluate(fixture.graph, one.when, values) == one.holds;
          }))
        return true;
    }
    return false;
  };
  SplitMix64 random{33};
  uint32_t possible = 0;
  constexpr uint32_t tries = 1500;
  for (uint32_t i = 0; i < tries; ++i) {
    std::vector<Condition> conditions(2 + random.below(5));
    for (Condition& one : conditions)
      one = {all[random.below(all.size())], random.below(2) == 0};
    uint64_t steps = 1u << 20;
    const bool found = can_hold(fixture.graph, conditions, steps);
    ASSERT_EQ(found, brute_force(conditions)) << "try " << i;
    ASSERT_GT(steps, 0u);
    possible += found;
  }
  EXPECT_GT(possible, tries / 4);
  EXPECT_LT(possible, tries * 9 / 10);
}

} // namespace
} // namespace dermis
