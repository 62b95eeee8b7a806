// Checks that docs/ describes files and messages as the code implements them.

#include "tests/framegraph/model_support.hpp"
#include "tests/support/text_file.hpp"

namespace dermis {
namespace {

std::string read_documentation(const char* name) {
  std::string text = test::read_text(std::string(DERMIS_SOURCE_DIR) + "/docs/" + name);
  EXPECT_FALSE(text.empty()) << name;
  return text;
}

TEST(Documentation, EveryDiagnosticHasAnEntry) {
  const std::string text = read_documentation("diagnostics.md");
  for (const DiagnosticInfo& info : all_diagnostic_infos()) {
    const std::string heading =
        "\n### " + std::string(info.code) + " " + std::string(info.name) + "\n\n";
    EXPECT_NE(text.find(heading), std::string::npos)
        << "docs/diagnostics.md lacks the entry:" << heading;
  }
}

TEST(Documentation, TheWorkedExampleOfTheGraphFileIsAGraph) {
  const std::string text = read_documentation("format.md");
  const std::string fence = "```jsonc\n";
  const size_t begin = text.find(fence);
  ASSERT_NE(begin, std::string::npos);
  const size_t end = text.find("```", begin + fence.size());
  ASSERT_NE(end, std::string::npos);
  const testing::Read example =
      testing::read(text.substr(begin + fence.size(), end - begin - fence.size()));
  EXPECT_TRUE(example.graph) << testing::all_messages(example.diagnostics);
}

TEST(Documentation, EveryFormatIsListed) {
  const std::string text = read_documentation("format.md");
  for (size_t i = 1; i < static_cast<size_t>(Format::count); ++i) {
    const std::string name(format_info(static_cast<Format>(i)).name);
    EXPECT_NE(text.find(name), std::string::npos) << name;
  }
}

} // namespace
} // namespace dermis
