// Tests `dermis bench error-time`: rows, files and messages, on small scenes.
#include "tests/integration/tools/command_fixture.hpp"

#include <algorithm>
#include <sstream>

namespace {

using namespace dermis::test;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

class BenchErrorTime : public CommandTest {
protected:
  std::string bench_file(const std::string& technique) const {
    return write("bench.json", R"({
      "dermis_benchmark": 1, "repetitions": 2, "warm_up": 1, "subset": 64, "skin": "configs/profiles/skin.json",
      "baseline": { "technique": "separable", "setting": "taps=11" },
      "self": { "setting": "samples", "samples": 64, "scenes": ["edge/close"] },
      "scenes": [ { "scene": "edge", "framing": "close", "d_px": [1, 2] },
                  { "scene": "head", "framing": "natural", "file": "configs/scenes/head_study.json", "model": true },
                  { "scene": "texture_plane", "framing": "varying", "d_px": [2] } ],
      "techniques": [ )" + technique +
                                   R"(
        { "technique": "burley", "setting": "n=8", "graph": "configs/graphs/burley.json", "set": { "samples": 8 },
          "heat_map": true },
        { "technique": "separable", "setting": "taps=11", "graph": "configs/graphs/separable.json", "set": { "taps": "11" } } ] })");
  }
  std::vector<std::string> arguments(const std::string& file) const {
    return {"bench",  "error-time",     "--file",  file,
            "--size", "48x32",          "--cache", path("cache"),
            "--json", path("out.json"), "--csv",   path("out.csv"),
            "--html", path("out.html")};
  }
  // Returns the rows without their times and what follows from them.
  std::vector<std::string> errors() const {
    std::istringstream csv(read(path("out.csv")));
    std::vector<std::string> rows;
    std::string row;
    std::getline(csv, row); // titles
    while (std::getline(csv, row)) {
      std::istringstream cells(row);
      std::string cell, kept;
      for (int i = 0; std::getline(cells, cell, ','); ++i)
        if (i < 5 || (i > 10 && i < 22)) kept += cell + ' ';
      rows.push_back(kept);
    }
    return rows;
  }
};

TEST_F(BenchErrorTime, WritesARowPerSceneAndTechnique) {
  const std::string missing =
      R"({ "technique": "unheard_of", "setting": "", "graph": "configs/graphs/none.json" },)";
  ASSERT_THAT(run(arguments(bench_file(missing))),
              Succeeds("graph 'configs/graphs/none.json' does not exist",
                       "no model is given (--head FOLDER)"));
  const std::string json = read(path("out.json"));
  EXPECT_TRUE(is_json(json));
  for (const char* key :
       {"scene", "d_px", "framing", "technique", "setting", "device_ms", "sampling_ms", "mean_spp",
        "reads_per_pixel", "rmse", "psnr_db", "max_error", "p99_error", "psnr_db_sdr8",
        "psnr_db_self", "transient_bytes", "dispatches", "on_pareto_front"})
    EXPECT_THAT(json, HasSubstr(std::string("\"") + key + "\": ")) << key;
  const std::string csv = read(path("out.csv"));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 3 * 2);
  EXPECT_THAT(read(path("out.html")), HasSubstr("</html>"));
  EXPECT_THAT(files("cache"), ::testing::SizeIs(3));
}

// Device times decide how many frames run per scene. The noise of the next scene must not depend on
// that number.
TEST_F(BenchErrorTime, ErrorsDependOnNothingButTheScene) {
  const std::string file = bench_file("");
  ASSERT_EQ(run(arguments(file)).exit_code, 0);
  const std::vector<std::string> all = errors();
  ASSERT_EQ(all.size(), 6u);
  std::vector<std::string> alone = arguments(file);
  alone.insert(alone.end(), {"--scenes", "texture_plane"});
  ASSERT_EQ(run(alone).exit_code, 0);
  EXPECT_THAT(errors(), ElementsAre(all[4], all[5]));
}

// Scenes share a graph. Its sequence of samples must start again with each scene.
TEST_F(BenchErrorTime, FramesOfEarlierScenesDoNotMatter) {
  std::vector<std::string> arguments = {
      "bench",   "error-time",  "--family", "--quick", "--csv",        path("out.csv"),
      "--cache", path("cache"), "--frames", "6",       "--techniques", "sap_residual"};
  arguments.insert(arguments.end(), {"--scenes", "fold,wave"});
  ASSERT_EQ(run(arguments).exit_code, 0);
  const std::vector<std::string> all = errors();
  ASSERT_GT(all.size(), 1u);
  arguments.back() = "wave";
  ASSERT_EQ(run(arguments).exit_code, 0);
  EXPECT_EQ(errors().front(), all[1]);
}

TEST_F(BenchErrorTime, ErrorsAreEqualWithAndWithoutTheCache) {
  const std::string file = bench_file("");
  ASSERT_EQ(run(arguments(file)).exit_code, 0);
  const std::vector<std::string> first = errors();
  ASSERT_EQ(run(arguments(file)).exit_code, 0);
  EXPECT_EQ(errors(), first);
  for (const std::string& name : files("cache"))
    write("cache/" + name, "damaged");
  ASSERT_EQ(run(arguments(file)).exit_code, 0);
  EXPECT_EQ(errors(), first);
}

TEST_F(BenchErrorTime, InvalidFile_IsReported) {
  const std::string file = write("bad.json", R"({ "dermis_benchmark": 1, "repetitions": 0,
  "scenes": [ { "scene": "nowhere", "framing": "close", "d_px": [1] } ] })");
  EXPECT_THAT(run({"bench", "error-time", "--file", file}),
              FailsWith(1, "bad.json:1:", "'nowhere' is not a generated scene", "repetitions"));
  EXPECT_THAT(run({"bench", "error-time", "--file", file, "--json", path("out.json")}),
              FailsWith(1, "'nowhere' is not a generated scene"));
  const Outcome as_json = run({"bench", "error-time", "--file", file, "--json", "-"});
  EXPECT_EQ(as_json.exit_code, 1);
  EXPECT_TRUE(is_json(as_json.out));
  EXPECT_THAT(as_json.out, HasSubstr("'nowhere' is not a generated scene"));
}

TEST_F(BenchErrorTime, NothingToMeasure_IsReported) {
  const std::string file = bench_file("");
  EXPECT_EQ(run({"bench", "error-time", "--file", file, "--scenes", "nowhere"}).exit_code, 2);
  EXPECT_EQ(run({"bench", "error-time", "--file", file, "--techniques", "none"}).exit_code, 2);
  EXPECT_THAT(
      run({"bench", "error-time", "--file", file, "--scenes", "edge,egde,disk"}),
      FailsWith(2, "--scenes: unknown 'egde', 'disk'; available: edge, head, texture_plane"));
  EXPECT_THAT(run({"bench", "error-time", "--file", file, "--techniques", "burley,burly"}),
              FailsWith(2, "--techniques: unknown 'burly'; available: burley, separable"));
  EXPECT_THAT(
      run({"bench", "error-time", "--family", "--scenes", "plane,folds,judgin"}),
      FailsWith(2, "--scenes: unknown 'folds', 'judgin'; available: ", "fold, ", "judging, "));
  EXPECT_EQ(run({"bench", "error-time", "--size", "0x3"}).exit_code, 2);
}

TEST_F(BenchErrorTime, ShippedFileIsValid) {
  ASSERT_THAT(run({"bench", "error-time", "--scenes", "edge", "--techniques", "burley", "--size",
                   "16x16", "--csv", "-", "--cache", "", "--study"}),
              Succeeds(::testing::StartsWith("scene,d_px,framing")));
}

TEST_F(BenchErrorTime, MissingGraphs_AreNamed) {
  const std::string file = write("missing.json", R"({
      "dermis_benchmark": 1, "repetitions": 1, "warm_up": 1, "subset": 64, "skin": "configs/profiles/skin.json",
      "baseline": { "technique": "a", "setting": "" },
      "self": { "setting": "samples", "samples": 64, "scenes": [] },
      "scenes": [ { "scene": "edge", "framing": "close", "d_px": [2] } ],
      "techniques": [ { "technique": "a", "setting": "", "graph": "configs/graphs/none.json" } ] })");
  EXPECT_THAT(run(arguments(file)), FailsWith(1, "do not exist: configs/graphs/none.json"));
}

TEST_F(BenchErrorTime, UnusableGraphOrSetting_IsReported) {
  const std::string wrong =
      R"({ "technique": "wrong", "setting": "", "graph": "configs/graphs/burley.json",
                                 "set": { "sample": 8 } },)";
  EXPECT_THAT(run({"bench", "error-time", "--file", bench_file(wrong), "--size", "32x32"}),
              FailsWith(1, "configs/graphs/burley.json", "sample"));
}

} // namespace
