// Tests the frame of the bench suites with a suite that needs no device.
#include "integration/tools/command/bench/suite/suites.hpp"
#include "integration/tools/command/bench/suite/techniques.hpp"
#include "integration/tools/command/statistics.hpp"
#include "tests/support/test_folder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <fstream>
#include <numeric>
#include <set>

namespace dermis::tools {
namespace {

struct Square {
  uint64_t side = 0, limit = 0;
  uint64_t area() const { return side * side; }
  bool holds() const { return area() <= limit; }
};

demo::Result<> measure_squares(SuiteRun& run, const Emit<Square>& emit) {
  if (run.number("sides") == 0) return demo::Error{demo::ErrorKind::usage, "no side is selected"};
  for (uint64_t side = 1; side <= run.number("sides"); ++side)
    if (run.is_requested("names", "square")) emit({side, run.number("limit")});
  run.add_note("circles");
  run.add_note("circles");
  return demo::success();
}

Suite squares() {
  return make_suite<Square>({.name = "squares",
                             .what = "Measure squares",
                             .title = "Squares",
                             .options = {{"sides", "Number of sides", 3u, "", 2u},
                                         {"limit", "Largest area", 9u},
                                         only_option("names")}},
                            {{"side", "side", &Square::side},
                             {"area", "area", &Square::area},
                             {"holds", "holds", &Square::holds, {.goal = Goal::required}}},
                            measure_squares);
}

struct BenchSuite : ::testing::Test {
  const test::TestFolder folder;
  const Session session{.quiet = true, .command = "dermis bench squares"};

  ExitCode run(SuiteRequest request) const {
    request.json = (folder / "rows.json").string();
    request.csv = (folder / "rows.csv").string();
    return run_suite(session, squares(), request);
  }
  nlohmann::json document() const {
    std::ifstream file(folder / "rows.json");
    return nlohmann::json::parse(file);
  }
};

TEST_F(BenchSuite, WritesColumnsOfEmittedRows) {
  EXPECT_EQ(run(default_request(squares())), ExitCode::ok);
  const nlohmann::json found = document();
  EXPECT_EQ(found["dermis_bench"], "squares");
  EXPECT_EQ(found["facts"]["command"], "dermis bench squares");
  EXPECT_TRUE(found["facts"].contains("took"));
  EXPECT_EQ(found["notes"], nlohmann::json::parse(R"(["circles"])"));
  EXPECT_EQ(found["rows"].size(), 3u);
  EXPECT_EQ(found["rows"][2], nlohmann::json::parse(R"({ "side": 3, "area": 9, "holds": true })"));
}

TEST_F(BenchSuite, MissedGoal_FailsAndStillWritesFiles) {
  SuiteRequest request = default_request(squares());
  request.options["limit"] = uint64_t{4};
  EXPECT_EQ(run(request), ExitCode::problems);
  EXPECT_EQ(document()["rows"][2]["holds"], false);
}

TEST_F(BenchSuite, MissedGoal_OutputIsOneDocument) {
  SuiteRequest request = default_request(squares());
  request.options["limit"] = uint64_t{4};
  request.json = "-";
  Session as_json = session;
  as_json.json = true;
  ::testing::internal::CaptureStdout();
  const ExitCode code = run_suite(as_json, squares(), request);
  const std::string out = ::testing::internal::GetCapturedStdout();
  EXPECT_EQ(code, ExitCode::problems);
  EXPECT_THAT(out, ::testing::HasSubstr("\"rows\""));
  EXPECT_THAT(out, ::testing::Not(::testing::HasSubstr("\"ok\""))) << "a second document";
}

TEST_F(BenchSuite, UnwritableFile_DoesNotPreventTheOthers) {
  SuiteRequest request = default_request(squares());
  std::ofstream(folder / "file") << "no folder";
  request.json = (folder / "file/rows.json").string();
  request.csv = (folder / "rows.csv").string();
  EXPECT_EQ(run_suite(session, squares(), request), ExitCode::environment);
  EXPECT_FALSE(std::filesystem::exists(folder / "rows.csv")) << "nothing is measured";
  request.json = (folder / "new/rows.json").string();
  EXPECT_EQ(run_suite(session, squares(), request), ExitCode::ok);
  EXPECT_TRUE(std::filesystem::exists(folder / "new/rows.json"));
  Suite more = squares();
  const auto measure = more.run;
  more.run = [&](SuiteRun& run) {
    run.files.emplace_back((folder / "none/table").string(), "text");
    run.files.emplace_back((folder / "table").string(), "text");
    return measure(run);
  };
  request.json = (folder / "rows.json").string();
  EXPECT_EQ(run_suite(session, more, request), ExitCode::environment);
  EXPECT_TRUE(std::filesystem::exists(folder / "rows.json")) << "rows are not lost";
  EXPECT_TRUE(std::filesystem::exists(folder / "table"));
}

TEST_F(BenchSuite, QuickRun_TakesQuickValuesAndSaysSo) {
  SuiteRequest request = default_request(squares());
  request.quick = true;
  EXPECT_EQ(run(request), ExitCode::ok);
  EXPECT_EQ(document()["rows"].size(), 2u);
  EXPECT_THAT(document()["facts"]["quick"].get<std::string>(), ::testing::HasSubstr("meaningless"));
}

TEST_F(BenchSuite, NamesRestrictTheRows) {
  SuiteRequest request = default_request(squares());
  request.options["names"] = std::vector<std::string>{"circle"};
  EXPECT_EQ(run(request), ExitCode::ok);
  EXPECT_TRUE(document()["rows"].empty());
}

TEST_F(BenchSuite, Error_DecidesTheExitCode) {
  SuiteRequest request = default_request(squares());
  request.options["sides"] = uint64_t{0};
  EXPECT_EQ(run(request), ExitCode::usage);
  EXPECT_FALSE(std::filesystem::exists(folder / "rows.json"));
}

TEST(BenchSuites, DeclareDistinctNamesOptionsAndColumns) {
  std::set<std::string> names;
  for (const Suite& suite : bench_suites()) {
    EXPECT_TRUE(names.insert(suite.name).second) << suite.name;
    EXPECT_FALSE(suite.what.empty()) << suite.name;
    std::set<std::string> options{"quick", "json", "csv", "html"}, keys;
    for (const SuiteOption& option : suite.options) {
      EXPECT_TRUE(options.insert(option.name).second) << suite.name << " --" << option.name;
      if (option.quick) {
        EXPECT_EQ(option.quick->index(), option.value.index())
            << suite.name << " --" << option.name;
      }
    }
    for (const ReportColumn& column : suite.columns)
      EXPECT_TRUE(keys.insert(column.key).second) << suite.name << " " << column.key;
  }
  EXPECT_EQ(names.size(), 11u);
}

TEST(BenchTechniques, FewAreTheFirstOfSomeKinds) {
  std::vector<TechniqueRequest> all(5);
  const char* kinds[] = {"sap", "sap", "fixed", "burley", "sap"};
  for (size_t i = 0; i < all.size(); ++i) {
    all[i].technique = kinds[i];
    all[i].setting = std::to_string(i);
  }
  keep_few(all);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(name_of(all[0]), "sap 0");
  EXPECT_EQ(name_of(all[1]), "burley 3");
}

TEST(BenchStatistics, QuantilesAreNearestRanks) {
  const std::vector<double> values = {5, 1, 4, 2, 3};
  EXPECT_EQ(median(values), 3);
  EXPECT_EQ(quantile(values, 0), 1);
  EXPECT_EQ(quantile(values, 1), 5);
  EXPECT_EQ(spread_of(values).p90, 5);
  std::vector<double> many(32);
  std::iota(many.begin(), many.end(), 1.0);
  EXPECT_EQ(quantile(many, 0.95), 31) << "30 values are only 93.75 %";
  EXPECT_EQ(quantile(many, 0.25), 8);
  EXPECT_EQ(median({1, 100}), 50.5);
}

} // namespace
} // namespace dermis::tools
