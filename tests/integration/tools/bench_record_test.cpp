// Tests `dermis bench record`: the cost of recording, as a table and as rows.

#include "tests/integration/tools/command_fixture.hpp"

#include <fstream>
#include <nlohmann/json.hpp>

namespace dermis::test {
namespace {

struct BenchRecord : CommandTest {};

TEST_F(BenchRecord, RecordingAllocatesNothing) {
  ASSERT_THAT(run({"bench", "record", "--json", path("rows.json")}), Succeeds("chain of 100"));
  std::ifstream stream(path("rows.json"));
  const nlohmann::json rows = nlohmann::json::parse(stream).at("rows");
  ASSERT_GE(rows.size(), 4u);
  for (const nlohmann::json& row : rows) {
    EXPECT_EQ(row.at("allocations_per_frame"), 0.0) << row;
    EXPECT_EQ(row.at("descriptor_writes_per_frame"), 0.0) << row;
    EXPECT_GE(row.at("commands_per_frame").get<double>(), 4.0 * row.at("passes").get<double>())
        << row;
    EXPECT_GT(row.at("us_per_frame").at("median").get<double>(), 0.0) << row;
  }
  EXPECT_EQ(rows.back().at("passes"), 100u);
}

TEST_F(BenchRecord, AFolderWithoutGraphsIsNamed) {
  EXPECT_THAT(run({"bench", "record", "--graphs", path("none")}),
              FailsWith(1, path("none"), "--graphs"));
}

TEST_F(BenchRecord, AGraphWithErrorsIsExplained) {
  write("broken.json", "{ \"dermis\": 2, \"nam\": \"x\" }");
  EXPECT_THAT(run({"bench", "record", "--graphs", path("")}), FailsWith(1, "broken.json:1:16"));
}

} // namespace
} // namespace dermis::test
