// Tests `dermis docs`: the generated pages of docs/ match the declarations.
#include "tests/integration/tools/command_fixture.hpp"

#include <fstream>
#include <sstream>

namespace dermis::test {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class Docs : public CommandTest {};

TEST_F(Docs, PagesInTheRepositoryAreUpToDate) {
  const Outcome outcome = run({"docs", "--check"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
}

TEST_F(Docs, OldOrMissingPageIsNamed) {
  EXPECT_EQ(run({"docs", "--check", "--out", path("pages")}).exit_code, 1);
  ASSERT_EQ(run({"docs", "--out", path("pages")}).exit_code, 0);
  EXPECT_EQ(run({"docs", "--check", "--out", path("pages")}).exit_code, 0);
  EXPECT_TRUE(is_json(run({"docs", "--check", "--json", "--out", path("pages")}).out));
  write("pages/pass_types.md", "old");
  const Outcome outcome = run({"docs", "--check", "--out", path("pages")});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("pass_types.md"));
}

TEST_F(Docs, SlotTableIsABlockOfTheHostsPage) {
  write("pages/integration.md", "before\n<!-- slots: `dermis docs` writes what follows -->\nold\n"
                                "<!-- end of slots -->\nafter\n");
  EXPECT_EQ(run({"docs", "--check", "--out", path("pages")}).exit_code, 1);
  ASSERT_EQ(run({"docs", "--out", path("pages")}).exit_code, 0);
  EXPECT_EQ(run({"docs", "--check", "--out", path("pages")}).exit_code, 0);
  EXPECT_THAT(
      read("pages/integration.md"),
      AllOf(StartsWith("before\n"), EndsWith("<!-- end of slots -->\nafter\n"), Not(HasSubstr("old")),
            HasSubstr("\n| `lighting` | in, out | `rgba16f`, "), HasSubstr(" | required in all | "),
            HasSubstr("\n| `instances` | in | buffer, 64 bytes an element | optional in `restir` | ")));
  write("pages/integration.md", "no block");
  const Outcome outcome = run({"docs", "--check", "--out", path("pages")});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("integration.md has no block 'slots'"));
}

TEST_F(Docs, EveryLinkWithinAPageHasAHeading) {
  ASSERT_EQ(run({"docs", "--out", path("pages")}).exit_code, 0);
  std::ifstream file(path("pages/format_reference.md"));
  std::ostringstream whole;
  whole << file.rdbuf();
  const std::string text = whole.str();
  size_t links = 0;
  for (size_t at = text.find("](#"); at != std::string::npos; at = text.find("](#", at + 1)) {
    const std::string anchor = text.substr(at + 3, text.find(')', at) - at - 3); // name-format
    const size_t dash = anchor.rfind('-');
    ++links;
    EXPECT_THAT(text, HasSubstr("### " + anchor.substr(0, dash) + " (" + anchor.substr(dash + 1) + ")\n"))
        << anchor;
  }
  EXPECT_GT(links, 50u);
}

} // namespace
} // namespace dermis::test
