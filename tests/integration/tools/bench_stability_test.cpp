// Tests `dermis bench stability`: rows, exit code, and that the bench detects broken results.
#include "tests/integration/tools/command_fixture.hpp"

#include <nlohmann/json.hpp>

#include <fstream>
#include <map>
#include <set>

namespace dermis::test {
namespace {

class BenchStability : public CommandTest {};

TEST_F(BenchStability, GivesARowForEachCaseAndTechnique) {
  const std::string rows = path("rows.json"), page = path("rows.html");
  const Outcome outcome =
      run({"bench", "stability", "--techniques", "formula,sap,burley", "--cases",
           "light_nan,glare_in_the_dark,history_poisoned,size_1x7,velocity_nan,xi_1,"
           "guidance_updates_at_1",
           "--updates", "20000", "--json", rows, "--html", page});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
  const nlohmann::json document = nlohmann::json::parse(std::ifstream(rows));
  // Four cases of two settings of sap and two of burley, and a fifth case for the one with a
  // history; two formulas.
  EXPECT_EQ(document["rows"].size(), 4u * 4u + 1u + 2u);
  for (const auto& row : document["rows"]) {
    EXPECT_TRUE(row["holds"]) << row;
    EXPECT_EQ(row["nonfinite_pixels"], 0) << row;
    EXPECT_EQ(row["negative_pixels"], 0) << row;
    EXPECT_LE(row["max_abs_error"], row["bound"]) << row;
    EXPECT_EQ(row["recovered_after_frames"].is_null(), row["case"] != "history_poisoned") << row;
  }
  EXPECT_THAT(outcome.out, HasSubstr("all goals of 19 rows are met"));
}

TEST_F(BenchStability, UnevenRatio_DisturbsTheHistory) {
  const std::string rows = path("rows.json");
  EXPECT_THAT(run({"bench", "stability", "--techniques", "sap_residual", "--cases",
                   "red_comes,velocity_in_stripes,velocity_of_depth_in_stripes", "--updates",
                   "1000", "--json", rows}),
              Succeeds());
  const nlohmann::json document = nlohmann::json::parse(std::ifstream(rows));
  ASSERT_EQ(document["rows"].size(), 3u);
  for (const auto& row : document["rows"]) {
    if (row["case"] == "red_comes")
      EXPECT_GT(row["max_abs_error"], 0.5) << "a wrong ratio was learned: " << row;
    else
      EXPECT_EQ(row["max_abs_error"], 0.0) << row;
  }
}

// Only the overlay gives accumulated light a history; only guided samples have a sample count.
TEST_F(BenchStability, TestsOnlyTheOutputsOfATechnique) {
  const std::string techniques =
      write("techniques.json", R"({ "dermis_benchmark": 1, "techniques": [
    { "technique": "burley", "setting": "alone", "graph": "configs/graphs/burley.json" },
    { "technique": "burley", "setting": "accumulated", "graph": "configs/graphs/burley.json",
      "overlays": ["configs/overlays/accumulate.json"] },
    { "technique": "afis_guided", "setting": "ccv", "graph": "configs/graphs/papers/afis_guided.json",
      "set": { "guidance": "ccv" } } ] })");
  const std::string rows = path("rows.json");
  EXPECT_THAT(run({"bench", "stability", "--file", techniques, "--cases",
                   "velocity_nan,samples_in_a_tile,samples_under_exposure_x16,"
                   "depth_reversed_infinite_far,size_changes_every_frame,d_0_of_blue,"
                   "anything_anywhere,anything_under_even_light",
                   "--json", rows}),
              Succeeds());
  const nlohmann::json document = nlohmann::json::parse(std::ifstream(rows));
  std::map<std::string, std::set<std::string>> requested;
  for (const auto& row : document["rows"]) {
    EXPECT_TRUE(row["holds"]) << row;
    requested[row["technique"]].insert(row["case"]);
  }
  std::set<std::string> of_all{"depth_reversed_infinite_far", "size_changes_every_frame",
                               "d_0_of_blue", "anything_anywhere", "anything_under_even_light"};
  EXPECT_EQ(requested["burley alone"], of_all);
  of_all.insert("velocity_nan");
  EXPECT_EQ(requested["burley accumulated"], of_all);
  of_all.merge(std::set<std::string>{"samples_in_a_tile", "samples_under_exposure_x16"});
  EXPECT_EQ(requested["afis_guided ccv"], of_all);
}

// A pixel that was not visible before shows the mean of its neighbours' remainders.
TEST_F(BenchStability, NewPixels_AreNotBrighterThanAllLight) {
  EXPECT_THAT(run({"bench", "stability", "--techniques", "hybrid_afis_separable,skin", "--cases",
                   "anything_under_light_up_to_1", "--updates", "1000"}),
              Succeeds());
}

TEST_F(BenchStability, UnknownNames_AreRejected) {
  const auto selected = [&](const char* techniques, const char* cases) {
    return run(
        {"bench", "stability", "--techniques", techniques, "--cases", cases, "--updates", "1000"});
  };
  EXPECT_THAT(selected("formula", "none,xi_0"),
              FailsWith(2, "--cases: unknown 'none'; available: "));
  EXPECT_THAT(selected("formula,sapp", "samples_in_a_tile"),
              FailsWith(2, "--techniques: unknown 'sapp'; available: ", "sap, "));
  EXPECT_THAT(selected("formula", "samples_in_a_tile"),
              FailsWith(2, "none of these techniques runs one of these cases"));
}

} // namespace
} // namespace dermis::test
