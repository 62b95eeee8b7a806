// Tests sheet: one picture of techniques times materials.

#include "integration/tools/files/png.hpp"
#include "tests/integration/tools/command_fixture.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace dermis::test {
namespace {

class Sheet : public CommandTest {
protected:
  Outcome sheet(const std::vector<std::string>& more) const {
    std::vector<std::string> words{"sheet", "--out", path("sheet.png"), "--size", "48x27"};
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  }
};

TEST_F(Sheet, HasARowPerGraphAndAColumnPerMaterial) {
  ASSERT_THAT(sheet({"--graphs", "configs/graphs/sap.json", "--profiles",
                     "skin,configs/profiles/milk.json"}),
              Succeeds("none, sap", "skin, milk"));
  std::string problem;
  const auto picture = tools::read_png(path("sheet.png"), problem);
  ASSERT_TRUE(picture) << problem;
  ASSERT_EQ(picture->width, 48u * 2 + 4);
  ASSERT_EQ(picture->height, 27u * 2 + 4);
  const auto tile = [&](uint32_t row, uint32_t column) {
    std::vector<float> values;
    for (uint32_t y = 0; y < 27; ++y)
      for (uint32_t x = 0; x < 3 * 48; ++x)
        values.push_back(
            picture->values[3 * (size_t{row * 31 + y} * picture->width + column * 52) + x]);
    return values;
  };
  EXPECT_EQ(tile(0, 0), tile(0, 1)); // Without a graph the material has no effect.
  EXPECT_NE(tile(1, 0), tile(0, 0));
  EXPECT_NE(tile(1, 0), tile(1, 1));
}

TEST_F(Sheet, HasARowPerBudgetAndNamesItsChoice) {
  ASSERT_THAT(sheet({"--graphs", "separable", "--budgets", "1,2", "--profiles", "skin"}),
              Succeeds("none, separable within 1 ms, separable within 2 ms\n"));
  std::string problem;
  const auto picture = tools::read_png(path("sheet.png"), problem);
  ASSERT_TRUE(picture) << problem;
  EXPECT_EQ(picture->height, 27u * 3 + 2 * 4);
  EXPECT_THAT(sheet({"--budgets", "0.001", "--profiles", "skin"}),
              Succeeds("none, skin within 0.001 ms (technique=off)"));
  EXPECT_THAT(sheet({"--budgets", "0"}), FailsWith(2, "--budgets"));
  EXPECT_THAT(sheet({"--calibration", "x.json"}), FailsWith(2, "--budgets"));
}

TEST_F(Sheet, JsonOutputIsOneDocument) {
  ASSERT_THAT(sheet({"--graphs", "configs/graphs/sap.json", "--profiles",
                     "configs/profiles/skin.json", "--json"}),
              Succeeds(IsJson(), "\"rows\"", "\"columns\""));
}

TEST_F(Sheet, AMissingProfileIsNamed) {
  const Outcome outcome =
      sheet({"--graphs", "configs/graphs/sap.json", "--profiles", "nowhere.json"});
  EXPECT_NE(outcome.exit_code, 0);
  EXPECT_THAT(outcome.err, HasSubstr("nowhere.json"));
}

TEST_F(Sheet, UnwritableFolder_IsReportedBeforeRendering) {
  std::ofstream(path("file")) << "no folder";
  // Rendering would fail at the profile.
  EXPECT_THAT(run({"sheet", "--out", path("file/sheet.png"), "--profiles", "nowhere.json"}),
              FailsWith(3, "file"));
}

TEST_F(Sheet, MissingFolder_IsCreated) {
  EXPECT_THAT(run({"sheet", "--out", path("new/sheet.png"), "--size", "48x27", "--graphs",
                   "separable", "--profiles", "skin"}),
              Succeeds("none"));
  EXPECT_TRUE(std::filesystem::exists(path("new/sheet.png")));
}

TEST_F(Sheet, TooManyPixels_AreAUsageError) {
  EXPECT_THAT(run({"sheet", "--out", path("sheet.png"), "--size", "8192x16"}),
              FailsWith(2, "--size"));
}

} // namespace
} // namespace dermis::test
