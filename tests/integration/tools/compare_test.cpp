// Tests `dermis compare`: numbers computed by hand, and rejected input.
#include "integration/tools/files/exr.hpp"
#include "integration/tools/files/png.hpp"
#include "tests/integration/tools/command_fixture.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>

namespace dermis::test {
namespace {

class Compare : public CommandTest {
protected:
  std::string png(const std::string& name, uint8_t value, uint8_t corner) const {
    std::vector<uint8_t> rgb(32 * 16 * 3, value);
    rgb[0] = rgb[1] = rgb[2] = corner;
    std::string error;
    std::filesystem::create_directories(std::filesystem::path(path(name)).parent_path());
    EXPECT_TRUE(tools::write_png(path(name), 32, 16, rgb, error)) << error;
    return path(name);
  }
  std::string exr(const std::string& name, float value) const {
    tools::Image image = tools::Image::sized(16, 16, 3);
    std::fill(image.values.begin(), image.values.end(), value);
    std::string error;
    EXPECT_TRUE(tools::write_exr(path(name), image, {"R", "G", "B"}, error)) << error;
    return path(name);
  }
};

TEST_F(Compare, OneDifferentPixel_GivesTheKnownNumbers) {
  const std::string a = png("a.png", 100, 151), b = png("b.png", 100, 100);
  const Outcome outcome =
      run({"compare", a, b, "--region", "8,8,4x4", "--json", "--heat", path("heat.png")});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const nlohmann::json rows = nlohmann::json::parse(outcome.out)["rows"];
  ASSERT_EQ(rows.size(), 2u);
  // One of 512 pixels differs by 51/255 in every channel.
  EXPECT_NEAR(rows[0]["max_error"], 0.2, 1e-6);
  EXPECT_NEAR(rows[0]["rmse"], 0.2 / std::sqrt(512.0), 1e-6);
  EXPECT_NEAR(rows[0]["psnr_db"], -20 * std::log10(0.2 / std::sqrt(512.0)), 1e-4);
  EXPECT_LT(rows[0]["ssim"], 1.0);
  EXPECT_EQ(rows[0]["worst_x"], 0);
  EXPECT_EQ(rows[1]["psnr_db"], 100);
  EXPECT_NEAR(rows[1]["ssim"], 1.0, 1e-9);
  std::string error;
  const auto heat = tools::read_png(path("heat.png"), error);
  ASSERT_TRUE(heat) << error;
  EXPECT_GT(heat->at(0, 0, 0), heat->at(9, 9, 0));
}

TEST_F(Compare, ExposesLinearLightBeforeItCompares) {
  // 2.2 against 2: the exposure of the second is 0.5.
  const Outcome outcome = run({"compare", exr("a.exr", 2.2f), exr("b.exr", 2.0f), "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NEAR(nlohmann::json::parse(outcome.out)["rows"][0]["rmse"], 0.1, 1e-5);
}

TEST_F(Compare, FailsBelowTheRequestedPsnr) {
  const std::string a = png("a.png", 100, 151), b = png("b.png", 100, 100);
  EXPECT_THAT(run({"compare", a, b, "--min-psnr", "60"}), FailsWith(1, "60.00 dB"));
  EXPECT_EQ(run({"compare", a, b, "--min-psnr", "20"}).exit_code, 0);
  EXPECT_THAT(
      run({"compare", exr("a.exr", std::numeric_limits<float>::quiet_NaN()), exr("b.exr", 1)}),
      FailsWith(1, "not finite"));
}

TEST_F(Compare, Folders_FilesInOnlyOneAreNamed) {
  std::filesystem::create_directories(path("a/deep"));
  std::filesystem::create_directories(path("b/deep"));
  png("a/one.png", 10, 10);
  png("b/one.png", 10, 10);
  png("a/deep/two.png", 10, 10);
  png("b/deep/two.png", 20, 20);
  const Outcome both = run({"compare", path("a"), path("b"), "--json"});
  ASSERT_EQ(both.exit_code, 0) << both.err;
  EXPECT_EQ(nlohmann::json::parse(both.out)["rows"].size(), 2u);
  png("a/three.png", 10, 10);
  EXPECT_THAT(run({"compare", path("a"), path("b")}), FailsWith(1, "three.png"));
}

TEST_F(Compare, ComparesOnlyPixelsOfTheReferencesMask) {
  // A quarter was computed and is right; the rest is the input light and must be ignored.
  std::filesystem::create_directories(path("truth"));
  std::filesystem::create_directories(path("ours"));
  const tools::Image ours = [] {
    tools::Image image = tools::Image::sized(16, 16, 3);
    std::fill(image.values.begin(), image.values.end(), 0.5f);
    return image;
  }();
  tools::Image reference = ours, mask = tools::Image::sized(16, 16, 1);
  for (uint32_t y = 0; y < 16; ++y)
    for (uint32_t x = 0; x < 16; ++x) {
      mask.at(x, y, 0) = x < 4 ? 1.0f : 0.0f;
      for (uint32_t c = 0; c < 3; ++c)
        reference.at(x, y, c) = x < 4 ? 0.5f : 8.0f;
    }
  std::string error;
  const std::vector<std::string> rgb{"R", "G", "B"};
  ASSERT_TRUE(tools::write_exr(path("truth/reference.exr"), reference, rgb, error)) << error;
  ASSERT_TRUE(tools::write_exr(path("truth/mask.exr"), mask, {"Y"}, error)) << error;
  ASSERT_TRUE(tools::write_exr(path("ours/scattered.exr"), ours, rgb, error)) << error;
  for (const auto& [a, b] :
       {std::pair(path("ours"), path("truth")), std::pair(path("truth"), path("ours")),
        std::pair(path("ours/scattered.exr"), path("truth/reference.exr"))}) {
    const Outcome outcome = run({"compare", a, b, "--json", "--region", "0,0,2x2"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const nlohmann::json rows = nlohmann::json::parse(outcome.out)["rows"];
    ASSERT_EQ(rows.size(), 2u);
    EXPECT_EQ(rows[0]["rmse"], 0);
    EXPECT_EQ(rows[0]["pixels"], 64);
    EXPECT_FALSE(rows[0].contains("ssim")); // Its windows would include ignored pixels.
    EXPECT_EQ(rows[1]["pixels"], 4);
  }
  EXPECT_THAT(run({"compare", path("ours"), path("truth"), "--region", "8,0,2x2"}),
              FailsWith(1, "region 8,0,2x2 has no pixel to compare"));
  EXPECT_THAT(run({"compare", path("ours"), path("truth"), "--flip"}).err, HasSubstr("--subset"));
  EXPECT_EQ(run({"compare", path("ours"), path("truth"), "--heat", path("heat.png")}).exit_code, 0);
}

TEST_F(Compare, SummarisesAFolderAndDescribesTheMap) {
  png("a/one.png", 10, 10);
  png("b/one.png", 10, 61);
  png("a/two.png", 10, 10);
  png("b/two.png", 10, 10);
  const Outcome outcome = run({"compare", path("a"), path("b"), "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const nlohmann::json answer = nlohmann::json::parse(outcome.out);
  // One of 1,024 pixels differs by 51/255.
  EXPECT_NEAR(answer["all"]["rmse"], 0.2 / std::sqrt(1024.0), 1e-6);
  EXPECT_EQ(answer["all"]["pixels"], 1024);
  EXPECT_THAT(run({"compare", path("a"), path("b")}).out, HasSubstr("\nall "));
  const Outcome with_heat_map =
      run({"compare", path("a/one.png"), path("b/one.png"), "--heat", path("heat.png")});
  EXPECT_THAT(with_heat_map.out, HasAll(path("heat.png"), "1e-4"));
}

TEST_F(Compare, RejectsIncomparablePictures) {
  const std::string a = png("a.png", 100, 100), light = exr("light.exr", 1);
  EXPECT_THAT(run({"compare", a, light}).err, HasSubstr("16x16"));
  EXPECT_EQ(run({"compare", a, path("none.png")}).exit_code, 1);
  EXPECT_EQ(run({"compare", a, path("")}).exit_code, 1);
  EXPECT_EQ(run({"compare", a, a, "--region", "30,0,8x8"}).exit_code, 2);
  EXPECT_EQ(run({"compare", a, a, "--region", "a,b"}).exit_code, 2);
  EXPECT_EQ(run({"compare", a}).exit_code, 2);
}

TEST_F(Compare, LargeDifferencesAreNoFailure_WithoutALimit) {
  const std::string a = exr("a.exr", 8), b = exr("b.exr", 0.5f);
  const Outcome outcome = run({"compare", a, b, "--json"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const nlohmann::json answer = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(answer["ok"], true);
  EXPECT_LT(answer["rows"][0]["psnr_db"], 0);
  EXPECT_THAT(run({"compare", a, b, "--min-psnr", "0"}),
              FailsWith(1, "differ more than allowed: at least 0"));
}

TEST_F(Compare, RejectsFilesOfDifferentTypes) {
  const std::string light = exr("light.exr", 0.5f), shown = path("shown.png");
  std::string error;
  const std::vector<uint8_t> rgb(16 * 16 * 3, 188);
  ASSERT_TRUE(tools::write_png(shown, 16, 16, rgb, error)) << error;
  for (const auto& [a, b] : {std::pair(light, shown), std::pair(shown, light)})
    EXPECT_THAT(run({"compare", a, b}), FailsWith(1, "files of different types"));
}

TEST_F(Compare, FlipIsReportedOnRequest) {
  const std::string a = png("one/a.png", 0, 0), b = png("two/a.png", 255, 255);
  png("one/b.png", 90, 90);
  png("two/b.png", 90, 90);
  const Outcome outcome = run({"compare", path("one"), path("two"), "--flip", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const nlohmann::json rows = nlohmann::json::parse(outcome.out)["rows"];
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_NEAR(rows[0]["flip"], 0.96738,
              1e-5); // Black against white: tests/integration/tools/files/flip_test.cpp.
  EXPECT_EQ(rows[1]["flip"], 0.0);
  EXPECT_FALSE(
      nlohmann::json::parse(run({"compare", a, b, "--json"}).out)["rows"][0].contains("flip"));
  EXPECT_EQ(run({"compare", path("one"), path("two"), "--flip", "--max-flip", "0.9"}).exit_code, 1);
  EXPECT_EQ(
      run({"compare", path("one/b.png"), path("two/b.png"), "--flip", "--max-flip", "0"}).exit_code,
      0);
}

TEST_F(Compare, FlipOfLinearLightIgnoresTheUnit) {
  const auto flip_of = [&](float a, float b) {
    const Outcome outcome = run({"compare", exr("a.exr", a), exr("b.exr", b), "--flip", "--json"});
    return nlohmann::json::parse(outcome.out)["rows"][0]["flip"].get<double>();
  };
  EXPECT_NEAR(flip_of(2.5f, 2.0f), flip_of(640.0f, 512.0f), 1e-6);
  EXPECT_GT(flip_of(2.5f, 2.0f), 0.01);
}

TEST_F(Compare, FlipMapIsBrighterAtLargerDifferences) {
  const std::string a = png("a.png", 100, 255), b = png("b.png", 100, 100);
  ASSERT_EQ(run({"compare", a, b, "--flip", "--flip-map", path("map.png")}).exit_code, 0);
  std::string error;
  const auto map = tools::read_png(path("map.png"), error);
  ASSERT_TRUE(map) << error;
  EXPECT_GT(map->at(0, 0, 0), map->at(31, 15, 0));
  // The option needs --flip.
  EXPECT_EQ(run({"compare", a, b, "--flip-map", path("map.png")}).exit_code, 2);
}

} // namespace
} // namespace dermis::test
