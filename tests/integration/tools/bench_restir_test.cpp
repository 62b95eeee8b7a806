// Tests `dermis bench restir`: its measures and rows. Rays need the driver of
// tests/scripts/fetch_driver.sh; without the driver those tests are skipped.
#include "integration/tools/command/bench/restir/claims.hpp"
#include "integration/tools/command/bench/restir/regions.hpp"
#include "integration/tools/command/bench/restir/restir_file.hpp"
#include "integration/tools/command/bench/restir/variants.hpp"
#include "tests/integration/tools/command_fixture.hpp"
#include "tests/support/fetched_driver.hpp"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <set>

namespace dermis::tools {
namespace {

using test::FailsWith;
using test::Outcome;
using test::Succeeds;

const std::string sources = DERMIS_SOURCE_DIR;

TEST(BenchRestirFile, ShippedFileIsValidAndNamesExistingFiles) {
  Diagnostics diagnostics;
  const auto file = read_restir(sources + "/tests/benchmark/restir.json", diagnostics);
  ASSERT_TRUE(file.has_value());
  EXPECT_TRUE(std::filesystem::exists(sources + "/" + file->graph));
  std::set<std::string> scenes, techniques;
  for (const SceneRequest& scene : file->scenes) {
    EXPECT_TRUE(std::filesystem::exists(sources + "/" + scene.file)) << scene.file;
    scenes.insert(scene.scene);
  }
  for (const TechniqueRequest& technique : file->screen_space) {
    EXPECT_TRUE(std::filesystem::exists(sources + "/" + technique.graph)) << technique.graph;
    techniques.insert(technique.technique);
  }
  EXPECT_TRUE(scenes.contains("back_lit_ear"));
  EXPECT_TRUE(techniques.contains("sap"));
}

TEST(BenchRestirFile, UnknownEntry_IsRejectedWithThePlace) {
  Diagnostics diagnostics;
  EXPECT_FALSE(read_restir(sources + "/tests/benchmark/dynamic.json", diagnostics));
  EXPECT_TRUE(diagnostics.has_errors());
}

SettingDeclaration enumeration(const std::string& name, const std::vector<std::string>& options) {
  SettingDeclaration setting;
  setting.name = name;
  setting.type = SettingType::enumeration;
  setting.options = options;
  return setting;
}

TEST(RestirVariants, CoverEveryReuseWithEveryShift) {
  Graph graph;
  EXPECT_EQ(variants_of(graph).size(), 1u);
  graph.settings.push_back(enumeration("reuse", {"none", "spatial", "temporal"}));
  graph.settings.push_back(enumeration("shift", {"reconnection", "delayed"}));
  std::vector<std::string> found;
  for (const RestirVariant& one : variants_of(graph))
    found.push_back(one.reuse + " " + one.shift + (one.has_history() ? " with history" : ""));
  EXPECT_THAT(found,
              ElementsAre("none ", "spatial reconnection", "spatial delayed",
                          "temporal reconnection with history", "temporal delayed with history"));
}

TEST(RestirVariants, MorePathsInMoreTime_AreNotBetter) {
  EXPECT_DOUBLE_EQ(ratio_at_equal_time(0.25, 4, 1, 1), 1);
  EXPECT_DOUBLE_EQ(ratio_at_equal_time(0.25, 2, 1, 1), 0.5);
}

// Three pixels: the first has transmitted light, the second is lit from the front, the third is too
// thick.
TEST(RestirRegions, FindTransmittedLight) {
  CapturedFrame frame;
  frame.lighting = Image::sized(3, 1, 3);
  frame.back_lighting = Image::sized(3, 1, 3);
  frame.thickness = Image::sized(3, 1, 1);
  frame.thickness.values = {0.003f, 0.003f, 0.009f};
  frame.lighting.values = {0, 0, 0, 2, 2, 2, 0, 0, 0};
  frame.back_lighting.values = std::vector<float>(9, 1.0f);
  Reference reference;
  reference.pixels = {0, 1, 2};
  reference.light = {1, 1, 1, 2, 2, 2, 2, 2, 2};
  reference.population = 3;
  const RayRegions regions = split_by_light(reference, frame, 6);
  EXPECT_THAT(regions.through.pixels, ElementsAre(0u));
  EXPECT_THAT(regions.rest.pixels, ElementsAre(1u, 2u));
  const std::vector<float> found = {0.25f, 0.25f, 0.25f, 2, 2, 2, 1, 1, 1};
  const LightError error = measure_light(found, regions);
  EXPECT_NEAR(error.through.light, 0.25, 1e-6);
  EXPECT_NEAR(error.through.mse, 0.5625, 1e-6);
  EXPECT_NEAR(error.rest.light, 0.75, 1e-6);
  EXPECT_NEAR(error.rest.mse, 0.5, 1e-6);
  EXPECT_NEAR(error.all.mse, (0.5625 + 1) / 3, 1e-6);
  const std::vector<LightError> two = {error, LightError()};
  EXPECT_NEAR(mean_of(two).through.light, 0.125, 1e-6);
}

RestirRow row_of(const std::string& reuse, const std::string& shift, double mse) {
  RestirRow row{"restir", "1 path", {reuse, shift}, 1};
  row.error.all.mse = mse;
  return row;
}

TEST(RestirClaims, ExpectationsOfReuseAreChecked) {
  std::vector<RestirRow> rows = {row_of("none", "", 1),
                                 row_of("spatial", "reconnection", 1.2),
                                 row_of("spatial", "delayed", 0.5),
                                 row_of("spatial", "sequential", 1.25),
                                 row_of("spatiotemporal", "reconnection", 0.2),
                                 row_of("spatiotemporal", "delayed", 0.3),
                                 row_of("spatiotemporal", "sequential", 0.4)};
  expect_of_reuse(rows);
  EXPECT_FALSE(rows[0].max_mse);
  const std::vector<double> at_most = {1.1, 1.1, 1.32, 0.5, 0.25, 0.33};
  for (size_t i = 0; i < at_most.size(); ++i)
    EXPECT_NEAR(rows[i + 1].max_mse.value_or(0), at_most[i], 1e-12) << i;
  std::vector<RestirRow> sequential = {row_of("none", "", 1), row_of("spatial", "sequential", 2)};
  expect_of_reuse(sequential); // A sequence whose parts were not measured has no expectation.
  EXPECT_FALSE(sequential[1].max_mse);
}

struct BenchRestir : test::CommandTest {
  static test::RunOptions with_rays() {
    return {{"VK_DRIVER_FILES=" + dermis::testing::driver_with_ray_queries()}, "", ""};
  }
  nlohmann::json rows(const std::string& name) const {
    return nlohmann::json::parse(read(name)).at("rows");
  }
};

struct BenchRestirWithRayQueries : BenchRestir {
  void SetUp() override {
    BenchRestir::SetUp();
    if (dermis::testing::driver_with_ray_queries().empty())
      GTEST_SKIP() << "no driver with ray queries: run tests/scripts/fetch_driver.sh";
  }
};

TEST_F(BenchRestir, NoRayQueries_NamesTheDriverAndIsNoFailure) {
  const Outcome sequential = run({"bench", "restir", "--quick", "--cache", path("cache")});
  if (sequential.exit_code == 0) GTEST_SKIP() << "this device has ray queries";
  EXPECT_EQ(sequential.exit_code, 3);
  EXPECT_THAT(sequential.err, HasAll("no ray queries", "tests/scripts/fetch_driver.sh"));
  EXPECT_THAT(run({"bench", "all", "--out", path("out"), "--suites", "restir", "--quick"}),
              Succeeds("left out: "));
  EXPECT_THAT(read("out/index.html"), HasSubstr("left out: "));
  EXPECT_THAT(files("out"), ElementsAre("index.html", "index.json"));
}

TEST_F(BenchRestirWithRayQueries, RayRenderingIsNotMeasuredInScreenSpace) {
  EXPECT_THAT(
      run({"render", "configs/scenes/bust.json", "--graph", "configs/graphs/papers/restir.json",
           "--out", path("out"), "--size", "32x24", "--frames", "1"},
          with_rays()),
      Succeeds("not measured, the technique traces rays"));
}

TEST_F(BenchRestirWithRayQueries, WritesARowPerReuseAndTechnique) {
  const std::vector<std::string> arguments = {
      "bench",           "restir",       "--quick",        "--scenes",        "back_lit",
      "--shifts",        "reconnection", "--json",         path("rows.json"), "--html",
      path("page.html"), "--csv",        path("rows.csv"), "--cache",         path("cache")};
  ASSERT_THAT(run(arguments, with_rays()), Succeeds());
  const nlohmann::json found = rows("rows.json");
  for (const char* key : {"scene", "shift", "reuse", "samples", "device_ms", "mse",
                          "mse_ratio_to_none_at_equal_time", "light_through"})
    EXPECT_TRUE(found[0].contains(key)) << key;
  EXPECT_EQ(found[0]["technique"], "restir");
  EXPECT_EQ(found[0]["reuse"], "none");
  EXPECT_EQ(found[0]["mse_ratio_to_none_at_equal_time"], 1.0);
  for (const nlohmann::json& row : found) {
    EXPECT_GT(row["mse"].get<double>(), row["mse_of_reference"].get<double>()) << row;
    const double light = row["light_through"].get<double>();
    if (row["technique"] == "restir") {
      EXPECT_NEAR(light, 1, 0.5) << row; // The mean of some frames with one path per pixel.
    } else if (row["setting"] == "smooth") {
      EXPECT_LT(light, 0.5) << "screen space has no light from behind the sheet";
    }
  }
  EXPECT_THAT(read("page.html"), HasSubstr("back_lit, reference"));
  EXPECT_THAT(files("cache"), SizeIs(1));
  const auto kept = std::filesystem::last_write_time(path("cache/" + files("cache").front()));
  ASSERT_EQ(run(arguments, with_rays()).exit_code, 0);
  EXPECT_EQ(std::filesystem::last_write_time(path("cache/" + files("cache").front())), kept);
  const nlohmann::json again = rows("rows.json");
  for (size_t i = 0; i < found.size(); ++i)
    EXPECT_EQ(again[i]["mse"], found[i]["mse"]) << i;
}

TEST_F(BenchRestirWithRayQueries, MissingScene_LeavesNothingToMeasure) {
  EXPECT_THAT(run({"bench", "restir", "--quick", "--scenes", "none"}, with_rays()),
              FailsWith(2, "--scenes: unknown 'none'; available: back_lit"));
}

} // namespace
} // namespace dermis::tools
