// Tests `dermis bench record`: the cost of recording, as a table and as rows.

#include "tests/integration/tools/command_fixture.hpp"

#include <fstream>
#include <nlohmann/json.hpp>

namespace dermis::test {
namespace {

using ::testing::HasSubstr;

struct BenchRecord : CommandTest {};

TEST_F(BenchRecord, RecordingAllocatesNothing) {
  const Outcome outcome = run({"bench", "record", "--json", path("rows.json")});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("chain of 100"));
  std::ifstream stream(path("rows.json"));
  const nlohmann::json rows = nlohmann::json::parse(stream).at("rows");
  ASSERT_GE(rows.size(), 4u);
  for (const nlohmann::json& row : rows) {
    EXPECT_EQ(row.at("allocations_per_frame"), 0.0) << row;
    EXPECT_GE(row.at("commands_per_frame").get<double>(), 4.0 * row.at("passes").get<double>()) << row;
    EXPECT_GT(row.at("us_per_frame").at("median").get<double>(), 0.0) << row;
  }
  EXPECT_EQ(rows.back().at("passes"), 100u);
}

TEST_F(BenchRecord, AFolderWithoutGraphsIsNamed) {
  const Outcome outcome = run({"bench", "record", "--graphs", path("none")});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr(path("none")));
  EXPECT_THAT(outcome.err, HasSubstr("--graphs"));
}

TEST_F(BenchRecord, AGraphWithErrorsIsExplained) {
  write("broken.json", "{ \"dermis\": 2, \"nam\": \"x\" }");
  const Outcome outcome = run({"bench", "record", "--graphs", path("")});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, HasSubstr("broken.json:1:16"));
}

} // namespace
} // namespace dermis::test
