// Tests dermis graph --html without a browser; tests/integration/tools/viewer opens the page.
#include "tests/integration/tools/command_fixture.hpp"

#include <filesystem>
#include <fstream>
#include <sstream>

namespace dermis::test {
namespace {

class View : public CommandTest {
protected:
  // Skips if the command was built without the page.
  void SetUp() override {
    const Outcome outcome =
        run({"graph", "configs/graphs/burley.json", "--html", path("view.html"), "--quiet"});
    if (outcome.exit_code == 3 &&
        outcome.err.find("this program has no viewer") != std::string::npos)
      GTEST_SKIP() << outcome.err;
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    std::filesystem::remove(path("view.html"));
  }
};

size_t count(const std::string& text, std::string_view what) {
  size_t found = 0;
  for (size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1))
    ++found;
  return found;
}

TEST_F(View, FileContentsCannotEndAnElement) {
  const std::string plain = run({"graph", "configs/graphs/burley.json", "--html", "-"}).out;
  const std::string graph = write(
      "hostile.json",
      R"({ "dermis": 2, "name": "hostile", "note": "</script><script>hurt_the_reader()</script>",
    "imports": { "light": { "format": "rgba16f", "size": "view", "note": "</script>" } }, "passes": [], "exports": [] })");
  const Outcome hostile = run({"graph", graph, "--html", "-"});
  ASSERT_EQ(hostile.exit_code, 0) << hostile.err;
  EXPECT_EQ(count(hostile.out, "</script"), count(plain, "</script"));
  EXPECT_EQ(count(hostile.out, "hurt_the_reader"), 0u);
}

TEST_F(View, InvalidReport_IsRejectedWithItsPlace) {
  const std::string report =
      write("report.json", "{\n  \"passes\": [ { \"pass\": \"classify\" } ] }");
  EXPECT_THAT(
      run({"graph", "configs/graphs/burley.json", "--html", path("view.html"), "--frame", report}),
      FailsWith(1, "report.json:2:13: error[D0104 wrong_type]"));
  EXPECT_THAT(files(), ElementsAre("report.json"));
}

TEST_F(View, ReportOfAnotherGraph_IsRejected) {
  const auto page = [&](const char* size) {
    return run({"graph", "configs/graphs/burley.json", "--html", path("view.html"), "--frame",
                path("report.json"), "--size", size});
  };
  const std::string head = R"({ "graph": "my.json", "width": 640, "height": 360, "passes": [)"
                           "\n";
  write("report.json", head + R"({ "pass": "scatter", "milliseconds": 1 },
    { "pass": "up_3", "milliseconds": 2 } ] })");
  EXPECT_THAT(page("640x360"), FailsWith(1, "report.json:3:15",
                                         "report is of another graph ('my.json'): 'burley' "
                                         "has no pass 'up_3'"));
  EXPECT_THAT(files(), ElementsAre("report.json"));
  write("report.json", head + R"({ "pass": "scatter", "milliseconds": 1 } ] })");
  const Outcome other_size = page("320x180");
  EXPECT_THAT(other_size, Succeeds());
  EXPECT_THAT(other_size.err, HasSubstr("the report is of 640x360 pixels, the page shows plans "
                                        "for 320x180"));
  EXPECT_THAT(page("640x360").err, IsEmpty());
}

TEST_F(View, GraphWithErrors_HasNoPage) {
  const std::string graph =
      write("broken.json", R"({ "dermis": 2, "name": "broken", "passes": 3 })");
  EXPECT_EQ(run({"graph", graph, "--html", path("view.html")}).exit_code, 1);
  EXPECT_THAT(files(), ElementsAre("broken.json"));
}

TEST_F(View, FrameWithoutPage_IsAUsageError) {
  EXPECT_EQ(run({"graph", "configs/graphs/burley.json", "--frame", "report.json"}).exit_code, 2);
  EXPECT_EQ(run({"graph", "configs/graphs/burley.json", "--html", "a.html", "--json"}).exit_code,
            2);
}

} // namespace
} // namespace dermis::test
