// dermis docs writes the pages that follow from declarations.
#include "tests/integration/tools/command_fixture.hpp"

namespace dermis::test {
namespace {

class Docs : public CommandTest {};

TEST_F(Docs, EveryPageIsWritten) {
  ASSERT_THAT(run({"docs", "--json", "--out", path("pages")}), Succeeds(IsJson()));
  EXPECT_THAT(files("pages"), ElementsAre("format_reference.md", "pass_types.md", "slots.md"));
  EXPECT_THAT(
      read("pages/slots.md"),
      HasAll("\n| `lighting` | in, out | `rgba16f`, ", " | required in all | ",
             "\n| `instances` | in | buffer, 64 bytes per element | optional in `restir` | "));
  EXPECT_THAT(read("pages/pass_types.md"), HasSubstr("\n## subsurface.combine\n"));
}

TEST_F(Docs, EveryLinkWithinAPageHasAHeading) {
  ASSERT_EQ(run({"docs", "--out", path("pages")}).exit_code, 0);
  const std::string text = read("pages/format_reference.md");
  size_t links = 0;
  for (size_t at = text.find("](#"); at != std::string::npos; at = text.find("](#", at + 1)) {
    const std::string anchor = text.substr(at + 3, text.find(')', at) - at - 3); // name-format
    const size_t dash = anchor.rfind('-');
    ++links;
    EXPECT_THAT(text,
                HasSubstr("### " + anchor.substr(0, dash) + " (" + anchor.substr(dash + 1) + ")\n"))
        << anchor;
  }
  EXPECT_GT(links, 50u);
}

} // namespace
} // namespace dermis::test
