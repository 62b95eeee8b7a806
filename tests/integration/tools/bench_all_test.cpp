// Tests `dermis bench all`: an index of suites, and runs that continue after an interruption.
#include "tests/integration/tools/command_fixture.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace dermis::test {
namespace {

class BenchAll : public CommandTest {};

TEST_F(BenchAll, WritesPagesAndAnIndex_MeasuresNothingTwice) {
  const std::vector<std::string> arguments = {"bench",     "all",      "--out",
                                              path("out"), "--suites", "record"};
  ASSERT_THAT(run(arguments), Succeeds());
  EXPECT_THAT(files("out"),
              ElementsAre("index.html", "index.json", "record.csv", "record.html", "record.json"));
  const std::string index = read("out/index.html");
  EXPECT_THAT(index,
              HasAll("<a href='record.html'>",
                     "dermis bench record --json record.json --csv record.csv --html record.html",
                     "not measured")); // The other suites.
  EXPECT_THAT(index, HasSubstr("<dt>processor"));
  EXPECT_THAT(read("out/record.html"), HasSubstr("chain of 100"));

  const auto written = std::filesystem::last_write_time(path("out/record.json"));
  EXPECT_THAT(run(arguments), Succeeds("record is there from an earlier run"));
  EXPECT_EQ(std::filesystem::last_write_time(path("out/record.json")), written);

  // A suite is measured again if its page is missing or was made by another command line.
  std::filesystem::remove(path("out/record.html"));
  EXPECT_THAT(run(arguments).out, Not(HasSubstr("is there from an earlier run")));
  nlohmann::json state = nlohmann::json::parse(read("out/index.json"));
  state["suites"][0]["line"] = "dermis bench record --graphs elsewhere";
  std::ofstream(path("out/index.json")) << state;
  EXPECT_THAT(run(arguments).out, Not(HasSubstr("is there from an earlier run")));
}

TEST_F(BenchAll, FailedSuite_LeavesNoOldPage) {
  const std::vector<std::string> arguments = {"bench",    "all",    "--out",  path("out"),
                                              "--suites", "record", "--again"};
  ASSERT_EQ(run(arguments).exit_code, 0);
  std::filesystem::remove(path("out/record.html"));
  write("out/record.html/x", ""); // A folder has the page's name, so the page cannot be written.
  const Outcome outcome = run(arguments);
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.out, HasSubstr("failed"));
  EXPECT_THAT(read("out/index.html"), HasSubstr("<td class=t>failed"));
}

TEST_F(BenchAll, SuiteThatCannotRun_KeepsItsFiles) {
  RunOptions no_driver;
  no_driver.environment = {"VK_ICD_FILENAMES=/nonexistent.json",
                           "VK_DRIVER_FILES=/nonexistent.json"};
  const std::string earlier = R"({ "dermis_bench": "earlier" })";
  write("out/restir.json", earlier);
  EXPECT_EQ(run({"bench", "all", "--suites", "restir", "--out", path("out")}, no_driver).exit_code,
            0);
  EXPECT_EQ(read("out/restir.json"), earlier);
}

TEST_F(BenchAll, StoppedRun_ContinuesInItsMode) {
  std::vector<std::string> arguments = {"bench",          "all",       "--quick",
                                        "--out",          path("out"), "--suites",
                                        "record,compile", "--cache",   path("cache")};
  RunOptions stopped;
  stopped.interrupt_after = path("out/index.html"); // The index exists after the first suite.
  EXPECT_EQ(run(arguments, stopped).exit_code, 130);
  EXPECT_THAT(files("out"),
              ElementsAre("index.html", "index.json", "record.csv", "record.html", "record.json"));

  EXPECT_THAT(run(arguments), Succeeds("1 of 2: record is there from an earlier run"));
  EXPECT_THAT(read("out/index.html"), HasSubstr("dermis bench compile --quick --json"));
  EXPECT_THAT(read("out/compile.html"), HasSubstr("figures are meaningless"));
  // Every row of the whole suite, up to graphs of 10,000 passes.
  const nlohmann::json rows = nlohmann::json::parse(read("out/compile.json"))["rows"];
  EXPECT_EQ(rows.size(), 50u);
  EXPECT_EQ(std::count_if(rows.begin(), rows.end(),
                          [](const auto& row) { return row["passes"] == 10000; }),
            11);

  nlohmann::json state = nlohmann::json::parse(read("out/index.json"));
  ASSERT_EQ(
      state["suites"][1]["line"],
      "dermis bench compile --quick --json compile.json --csv compile.csv --html compile.html");
  state["suites"][1]["line"] =
      // The command line of a whole run.
      "dermis bench compile --json compile.json --csv compile.csv --html compile.html";
  std::ofstream(path("out/index.json")) << state;
  EXPECT_THAT(run(arguments).out, Not(HasSubstr("compile is there")));
}

TEST_F(BenchAll, UnknownSuite_IsAUsageError) {
  EXPECT_THAT(run({"bench", "all", "--out", path("out"), "--suites", "recrod"}),
              FailsWith(2, "did you mean 'record'?"));
  EXPECT_THAT(files(), IsEmpty());
}

TEST_F(BenchAll, ForeignIndex_IsKept) {
  const std::string foreign = R"({ "pages": [] })";
  write("out/index.json", foreign);
  EXPECT_THAT(run({"bench", "all", "--out", path("out"), "--suites", "record"}),
              FailsWith(2, "out/index.json", "is not a report of a bench"));
  EXPECT_EQ(read("out/index.json"), foreign);
}

TEST_F(BenchAll, DamagedIndex_IsIgnored) {
  write(
      "out/index.json",
      R"({ "dermis_bench": 1, "suites": [ { "suite": 1, "line": [], "exit_code": "x", "seconds": null } ] })");
  EXPECT_EQ(run({"bench", "all", "--out", path("out"), "--suites", "record"}).exit_code, 0);
}

} // namespace
} // namespace dermis::test
