// Tests the texts of reports: differences by line, and XML with any content.

#include "integration/tools/command/expect/junit.hpp"
#include "integration/tools/command/expect/text_diff.hpp"

#include <gtest/gtest.h>

#include <string>

namespace dermis::test {
namespace {

using tools::diff_lines;

// Returns one side of a difference: its own lines and the common lines, without marks.
std::string side(const std::string& difference, char own) {
  std::string out;
  for (size_t at = 0; at < difference.size();) {
    const size_t end = difference.find('\n', at);
    if (difference[at] == own || difference[at] == ' ')
      out += difference.substr(at + 2, end - at - 1);
    at = end + 1;
  }
  return out;
}

size_t marked(const std::string& difference) {
  size_t count = 0;
  for (size_t at = 0; at < difference.size(); at = difference.find('\n', at) + 1)
    count += difference[at] != ' ';
  return count;
}

// Returns text `number` of `lines` lines, each "a" or "b".
std::string short_text(uint32_t number, uint32_t lines) {
  std::string out;
  for (uint32_t i = 0; i < lines; ++i)
    out += (number >> i & 1u) != 0 ? "a\n" : "b\n";
  return out;
}

TEST(Difference, ContainsBothTexts) {
  for (uint32_t a = 0; a < 32; ++a)
    for (uint32_t b = 0; b < 32; ++b)
      for (uint32_t lines = 0; lines <= 5; ++lines) {
        const std::string before = short_text(a, 5), after = short_text(b, lines);
        const std::string difference = diff_lines(before, after);
        ASSERT_EQ(side(difference, '-'), before) << difference;
        ASSERT_EQ(side(difference, '+'), after) << difference;
      }
}

TEST(Difference, MarksTheFewestLines) {
  EXPECT_EQ(diff_lines("a\nb\n", "a\nb\n"), "  a\n  b\n");
  EXPECT_EQ(diff_lines("", "a\n"), "+ a\n");
  EXPECT_EQ(diff_lines("x\na\nb\nc\ny\n", "x\na\nc\nd\ny\n"), "  x\n  a\n- b\n  c\n+ d\n  y\n");
  EXPECT_EQ(marked(diff_lines("a\nb\na\nb\n", "b\na\nb\na\n")), 2u);
}

TEST(Difference, LongTexts_AreContained) {
  std::string before, after;
  for (int i = 0; i < 5000; ++i) {
    before.append("b").append(std::to_string(i)).append("\n");
    after.append("a").append(std::to_string(i)).append("\n");
  }
  const std::string difference = diff_lines(before, after);
  EXPECT_EQ(side(difference, '-'), before);
  EXPECT_EQ(side(difference, '+'), after);
}

TEST(JUnit, EscapesAnyContent) {
  EXPECT_EQ(tools::xml_text("<a b=\"&\">\n\x01\x7f"), "&lt;a b=&quot;&amp;&quot;&gt;\n??");
  EXPECT_EQ(tools::junit_xml({{"f", {{"good", true, "", ""}, {"bad", false, "why", "more\n"}}}}),
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
            "<testsuites name=\"dermis test\" tests=\"2\" failures=\"1\">\n"
            "  <testsuite name=\"f\" tests=\"2\" failures=\"1\">\n"
            "    <testcase classname=\"f\" name=\"good\"/>\n"
            "    <testcase classname=\"f\" name=\"bad\">\n"
            "      <failure message=\"why\">more\n</failure>\n"
            "    </testcase>\n"
            "  </testsuite>\n"
            "</testsuites>\n");
}

} // namespace
} // namespace dermis::test
