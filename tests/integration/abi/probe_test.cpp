// The error probe measures the error that the exact reference gives.

#include "framegraph/text/document.hpp"
#include "integration/examples/demo_engine/render/reported_frame.hpp"
#include "passes/common/profiles/profile.hpp"
#include "passes/common/reference/reference.hpp"
#include "tests/integration/abi/dermis_fixture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace dermis::abi_test {
namespace {

constexpr uint32_t probed_side = 64; // One run of tiles: each frame probes one.

struct Probe : DermisTest {
  dermis_graph graph = nullptr;
  using Light = float (*)(uint32_t x, uint32_t y);

  void set(const char* setting, const char* json) {
    ASSERT_OK(dermis_graph_set_setting(graph, setting, json, nullptr));
  }
  void make(const char* technique, bool probing = true, const char* last_step = "\"fused\"") {
    graph = make_graph(shipped_options("configs/graphs/skin.json"));
    set("technique", technique);
    set("last_step", last_step);
    set("probe", probing ? "\"on\"" : "\"off\"");
    set("probe_interval", "1");
    make_images(graph);
  }

  demo::ReportedFrame run_frame(Light light) {
    fill("lighting", light);
    return DermisTest::run_frame(graph);
  }
  void set_budget(float ms) {
    dermis_budget budget = DERMIS_BUDGET_INIT;
    budget.milliseconds = ms;
    budget.flags = DERMIS_BUDGET_DETERMINISTIC;
    ASSERT_OK(dermis_graph_set_budget(graph, &budget, nullptr));
  }
  // Runs frames of `technique=partial` within a budget, in light that changes all tiles alike.
  // Returns the last frame; adds the probed squares to `squares`.
  demo::ReportedFrame run_partial(float ms, int frames, double* squares = nullptr);

  // Returns the light, three values per pixel.
  static std::vector<float> lit_by(Light light) {
    std::vector<float> lit;
    for (uint32_t y = 0; y < probed_side; ++y)
      for (uint32_t x = 0; x < probed_side; ++x)
        lit.insert(lit.end(), 3, light(x, y));
    return lit;
  }
  static double unscattered_error(Light light) { return squared_error(light, lit_by(light)); }
  // Returns the mean squared luminance error of `shown`, three values per pixel.
  static double squared_error(Light light, const std::vector<float>& shown) {
    Diagnostics diagnostics;
    const auto document =
        parse_document("skin", read_text("configs/profiles/skin.json"), diagnostics);
    const auto skin = subsurface::read_profile(*document, diagnostics);
    const std::vector<float> lit = lit_by(light);
    const std::vector<float> depth(size_t{probed_side} * probed_side, 0.5f);
    const std::vector<uint8_t> ids(size_t{probed_side} * probed_side, 1);
    const std::vector<subsurface::PerChannel> d_m = {
        {}, {skin->d_mm[0] * 1e-3, skin->d_mm[1] * 1e-3, skin->d_mm[2] * 1e-3}};
    subsurface::ReferenceInput input;
    input.width = input.height = probed_side;
    input.rays.perspective = false;
    input.rays.scale_x = input.rays.scale_y = pitch_m;
    input.light = lit;
    input.depth = depth;
    input.profile = ids;
    input.d_m = d_m;
    const std::vector<double> reference = subsurface::reference_everywhere(input);
    constexpr std::array luminance = {0.2126, 0.7152, 0.0722}; // Rec. 709
    double squares = 0;
    for (size_t i = 0; i < lit.size() / 3; ++i) {
      double off = 0;
      for (size_t c = 0; c < 3; ++c)
        off += luminance[c] * (double(shown[3 * i + c]) - reference[3 * i + c]);
      squares += off * off;
    }
    return squares / (double(probed_side) * probed_side);
  }
};

float checks(uint32_t x, uint32_t y) {
  return (x + y) % 2 == 0 ? 0.25f : 0.75f;
}
float waves(uint32_t x, uint32_t y) {
  return float(0.5 + 0.4 * std::sin(0.5 * x) * std::sin(0.4 * y));
}
float spread(uint32_t x, uint32_t y) {
  return float((x * 37 + y * 61) % 97) / 64.0f;
}

demo::ReportedFrame Probe::run_partial(float ms, int frames, double* squares) {
  last_frame = 0;
  make("\"partial\"");
  set_budget(ms);
  demo::ReportedFrame shown;
  for (int i = 0; i < frames; ++i) {
    shown = run_frame(spread);
    if (squares != nullptr) *squares += std::pow(double(shown.probed_rmse), 2);
  }
  return shown;
}

TEST_F(Probe, WithoutProbe_TheErrorIsUnknown) {
  make("\"sap\"", false);
  const demo::ReportedFrame choice = run_frame(spread);
  EXPECT_EQ(choice.probed_tiles, 0u);
  EXPECT_EQ(choice.probed_rmse, 0);
}

TEST_F(Probe, MatchesTheExactReference) {
  // Each pixel of a chequered light has an equal error, except near the picture's border: 1 % from
  // tile to tile, 0.5 % of a mean over frames. The pole of the centre pixel contributes 2 %.
  make("\"off\"");
  constexpr int frames = 64;
  double mean = 0;
  for (int i = 0; i < frames; ++i) {
    const demo::ReportedFrame choice = run_frame(checks);
    EXPECT_EQ(choice.probed_tiles, 1u);
    mean += std::pow(double(choice.probed_rmse), 2) / frames;
    EXPECT_EQ(choice.probed_rmse_low, 0); // One tile gives no bound for the others.
    EXPECT_TRUE(std::isinf(choice.probed_rmse_high));
  }
  const double exact = std::sqrt(unscattered_error(checks));
  EXPECT_NEAR(std::sqrt(mean), exact, 5e-3 * exact);
}

TEST_F(Probe, MeanOverFramesIsThePicturesError) {
  make("\"off\"");
  const double exact = unscattered_error(spread);
  constexpr int frames = 48;
  double sum = 0, squares = 0;
  for (int i = 0; i < frames; ++i) {
    const double found = std::pow(double(run_frame(spread).probed_rmse), 2);
    sum += found;
    squares += found * found;
  }
  const double mean = sum / frames,
               deviation = std::sqrt((squares / frames - mean * mean) / (frames - 1));
  EXPECT_NEAR(mean, exact, 4 * deviation);
  EXPECT_LT(deviation, 0.2 * exact); // Otherwise the comparison means nothing.
}

// The view is 64 tiles wide, so each of its 32 rows of tiles is a run; a frame probes five of them.
TEST_F(Probe, EveryPartOfALargeView_IsProbedAsOften) {
  constexpr uint32_t width = 512, height = 256, rows = height / 8;
  GraphOptions options = shipped_options("configs/graphs/skin.json");
  options.width = width;
  options.height = height;
  graph = make_graph(options);
  set("technique", "\"off\"");
  set("probe", "\"on\"");
  set("probe_interval", "1");
  set("probe_tiles", "5");
  make_images(graph);
  const auto mean_square = [&](const std::function<float(uint32_t row)>& amplitude, int frames) {
    fill("lighting", [&](uint32_t x, uint32_t y) {
      return 0.5f + (2.0f * checks(x, y) - 1) * amplitude(y / 8);
    });
    double mean = 0;
    for (int i = 0; i < frames; ++i) {
      dermis_frame one = bound_frame(graph, width, height);
      const demo::ReportedFrame shown = record_and_read(graph, one);
      EXPECT_EQ(shown.probed_tiles, 5u);
      mean += std::pow(double(shown.probed_rmse), 2) / frames;
    }
    return mean;
  };
  const double even = mean_square([](uint32_t) { return 0.5f; }, 4);
  constexpr int frames = 64;
  for (const uint32_t bright : {0u, rows - 1}) { // Only this row has an error.
    const double part =
        mean_square([=](uint32_t row) { return row == bright ? 0.5f : 0.0f; }, frames);
    EXPECT_NEAR(part / even, 1.0 / rows, 0.024) << bright; // 2.6 standard deviations
  }
  const auto rising = [](uint32_t row) { return std::sqrt(float(row) / rows) / 2; };
  EXPECT_NEAR(mean_square(rising, frames) / even, 0.5, 0.02);
}

TEST_F(Probe, MeasuredErrorCorrectsTheExpectedError) {
  make("\"off\"", false);
  run_frame(checks);
  const float before = run_frame(checks).predicted_rmse; // From the table, once tiles were counted.
  make("\"off\"");
  demo::ReportedFrame choice;
  for (int i = 0; i < 60; ++i)
    choice = run_frame(checks);
  EXPECT_GT(std::abs(before - choice.probed_rmse),
            0.3f * choice.probed_rmse); // The light differs from the table's.
  // Each frame has the same error, in units of this light.
  EXPECT_NEAR(choice.predicted_rmse, choice.probed_rmse, 0.02 * choice.probed_rmse);
}

// Single frames tell little about a small error, but their mean is right.
TEST_F(Probe, SmallErrors_AreFoundInTheMean) {
  for (const char* technique : {"\"separable\"", "\"sap\""}) {
    make(technique, false);
    run_frame(waves);
    const double table = run_frame(waves).predicted_rmse;
    make(technique);
    double corrected = 0;
    constexpr int frames = 200, judged = 100;
    for (int i = 0; i < frames; ++i) {
      const double error = run_frame(waves).predicted_rmse;
      if (i >= frames - judged) corrected += error / judged;
    }
    std::vector<float> shown;
    const std::vector<float> result = texels("lighting");
    for (size_t i = 0; i < result.size(); ++i)
      if (i % 4 < 3) shown.push_back(result[i]);
    const double exact = std::sqrt(squared_error(waves, shown));
    const std::string what = fmt::format("{}: {} in the table, {} corrected, {} exact", technique,
                                         table, corrected, exact);
    RecordProperty(std::string(technique).substr(1, 3), what);
    EXPECT_LT(exact, 0.01) << what;
    EXPECT_NEAR(corrected, exact, 0.3 * exact) << what;
  }
}

TEST_F(Probe, SampledTilesShareTheirPyramidsCorrection) {
  const auto from_table = [&](const char* technique) {
    make(technique, false);
    run_frame(spread);
    return double(run_frame(spread).predicted_rmse);
  };
  const double sap = from_table("\"sap\""), hybrid = from_table("\"hybrid\"");
  make("\"sap\"");
  double corrected = 0;
  for (int i = 0; i < 30; ++i)
    corrected = double(run_frame(spread).predicted_rmse);
  const double factor = corrected / sap;
  EXPECT_GT(std::abs(std::log(factor)), 0.2); // The light differs from the table's.
  ASSERT_OK(dermis_graph_set_setting(graph, "technique", "\"hybrid\"", nullptr));
  make_images(graph);
  run_frame(spread); // The requested samples are unknown before.
  // Both frames were probed, too, in one tile each.
  EXPECT_NEAR(double(run_frame(spread).predicted_rmse), factor * hybrid, 0.35 * factor * hybrid);
}

// While another technique runs, the probe computes what the separable technique would show.
TEST_F(Probe, MeasuresSeparable_WhileOthersRun) {
  const auto fill_surface = [&] {
    fill("depth", [](uint32_t x, uint32_t y) {
      return (x / 24 + y / 20) % 2 == 0 ? 0.5f + 0.0002f * float(x % 24) : 0.51f;
    });
    fill("material", [](uint32_t x, uint32_t y) { return (x + 2 * y) % 31 < 4 ? 0.0f : 1.0f; });
  };
  const auto error_after = [&](const char* technique) {
    last_frame = 0; // Each frame number has its tiles.
    make(technique);
    fill_surface();
    for (int i = 0; i < 60; ++i)
      run_frame(spread);
    set("technique", "\"separable\"");
    make_images(graph);
    fill_surface();
    run_frame(spread);
    return double(run_frame(spread).predicted_rmse);
  };
  const double own = error_after("\"separable\"");
  for (const char* other : {"\"sap\"", "\"off\"", "\"partial\""})
    EXPECT_NEAR(error_after(other), own, 0.02 * own) << other;
  make("\"separable\"", false);
  fill_surface();
  run_frame(spread);
  EXPECT_GT(std::abs(std::log(double(run_frame(spread).predicted_rmse) / own)), 0.2)
      << "the table has this error, too";
}

// Tiles that the budget leaves out are measured, too.
TEST_F(Probe, MeasuresSeparable_WhileABudgetLeavesTilesOut) {
  const auto factor = [&](float ms) {
    const demo::ReportedFrame shown = run_partial(ms, 40);
    set("technique", "\"separable\"");
    set_budget(0); // 25 taps, which the probe measures
    make_images(graph);
    run_frame(spread);
    return std::pair(double(run_frame(spread).predicted_rmse), shown);
  };
  const auto [all, shown] = factor(1000);
  ASSERT_EQ(shown.sample_units, shown.sample_demand);
  float ms = shown.predicted_ms;
  for (; ms > 1e-3f; ms *= 0.8f)
    if (const auto [found, part] = factor(ms); part.sample_units < part.sample_demand / 2) {
      EXPECT_GT(part.sample_units, 0u);
      EXPECT_NEAR(found, all, 0.02 * all);
      return;
    }
  FAIL() << "no budget leaves tiles out";
}

TEST_F(Probe, MeasuresWhatSelectedTilesLeave) {
  float ms = run_partial(1000, 2).predicted_ms; // all tiles
  demo::ReportedFrame shown;
  do {
    ms *= 0.9f;
    shown = run_partial(ms, 2);
  } while (ms > 1e-3f && shown.sample_units >= shown.sample_demand / 2);
  ASSERT_GT(shown.sample_units, 0u);
  constexpr int frames = 80;
  double squares = 0;
  shown = run_partial(ms, frames, &squares);
  const double measured = std::sqrt(squares / frames);
  EXPECT_NEAR(shown.predicted_rmse, measured, 0.2 * measured);
}

TEST_F(Probe, FramesBeforeACut_DoNotCountAfterIt) {
  const auto settle = [&](bool probing) {
    make("\"separable\"", probing);
    for (int i = 0; i < 6; ++i)
      run_frame(spread);
    return double(run_frame(spread).predicted_rmse);
  };
  const double by_table = settle(false), corrected = std::abs(std::log(settle(true) / by_table));
  ASSERT_GT(corrected, 0.3);
  // The frame before the cut completes after the cut is recorded.
  dermis_frame before = bound_frame(graph);
  ASSERT_OK(record(graph, before));
  dermis_frame cut = bound_frame(graph);
  cut.completed_frame_index = before.frame_index - 1;
  cut.flags |= DERMIS_FRAME_RESET_HISTORY;
  ASSERT_OK(record(graph, cut));
  dermis_frame after = bound_frame(graph);
  after.completed_frame_index = before.frame_index;
  const double predicted = record_and_read(graph, after).predicted_rmse;
  EXPECT_LT(std::abs(std::log(predicted / by_table)), 0.2 * corrected);
}

TEST_F(Probe, PyramidIsBetterThanUnscatteredLight) {
  make("\"sap\"");
  const auto with = run_frame(spread);
  EXPECT_EQ(with.probed_tiles, 1u);
  EXPECT_LT(with.probed_rmse, 0.05 * std::sqrt(unscattered_error(spread)));
}

// The fused last step writes the host's light, so the probe needs the light of a pass of its own.
TEST_F(Probe, FusedLastStep_HasTheSameErrors) {
  const auto errors = [&](const char* variant, const char* last_step) {
    make("\"sap\"", true, last_step);
    set("variant", variant);
    make_images(graph);
    fill("depth", [](uint32_t x, uint32_t y) { return (x / 24 + y / 20) % 2 == 0 ? 0.5f : 0.51f; });
    std::vector<float> found;
    for (int i = 0; i < 12; ++i)
      found.push_back(run_frame(spread).probed_rmse);
    return found;
  };
  for (const char* variant : {"\"smooth\"", "\"base\""}) {
    last_frame = 0; // Each frame number has its tiles.
    const std::vector<float> separate = errors(variant, "\"separate\"");
    last_frame = 0;
    const std::vector<float> fused = errors(variant, "\"fused\"");
    EXPECT_EQ(fused, separate) << variant;
    EXPECT_GT(*std::max_element(fused.begin(), fused.end()), 1e-3f) << variant;
  }
}

TEST_F(Probe, ProbesOneOfSoManyFrames) {
  make("\"off\"");
  set("probe_interval", "4");
  constexpr int frames = 200;
  int probed = 0;
  for (int i = 0; i < frames; ++i)
    probed += run_frame(checks).probed_tiles > 0 ? 1 : 0;
  EXPECT_NEAR(probed, frames / 4, 20); // Three standard deviations.
}

// While the choice does not know the error of what runs, single pixels must not decide.
TEST_F(Probe, FirstFramesOfATechnique_AreAllProbed) {
  make("\"off\"");
  set("probe_interval", "256");
  const auto probed_of = [&](int frames) {
    int probed = 0;
    for (int i = 0; i < frames; ++i)
      probed += run_frame(checks).probed_tiles > 0 ? 1 : 0;
    return probed;
  };
  EXPECT_LE(probed_of(48), 2) << "without a budget, nothing is chosen";
  set_budget(1000);
  EXPECT_EQ(probed_of(16), 16);
  EXPECT_LE(probed_of(48), 2);
  set("technique", "\"sap\"");
  make_images(graph);
  EXPECT_EQ(probed_of(16), 16) << "of another technique";
  EXPECT_LE(probed_of(48), 2);
  set("technique", "\"separable\"");
  make_images(graph);
  EXPECT_LE(probed_of(48), 2) << "each probed frame measures it";
  set("technique", "\"sap\"");
  make_images(graph);
  EXPECT_LE(probed_of(48), 2) << "its error is known";
}

// Frames without subsurface tell nothing.
TEST_F(Probe, FirstFramesWithSubsurface_AreAllProbed) {
  make("\"separable\"");
  set("probe_interval", "256");
  set_budget(1000);
  fill("material", [](uint32_t, uint32_t) { return 0.0f; });
  for (int i = 0; i < 40; ++i)
    run_frame(checks);
  fill("material", [](uint32_t, uint32_t) { return 1.0f; });
  int probed = 0;
  for (int i = 0; i < 16; ++i)
    probed += run_frame(checks).probed_tiles > 0 ? 1 : 0;
  EXPECT_GE(probed, 12) << "up to the latency of counters less";
}

TEST_F(Probe, FirstFramesAfterACut_AreAllProbed) {
  make("\"off\"");
  set("probe_interval", "256");
  set_budget(1000);
  for (int i = 0; i < 20; ++i)
    run_frame(checks);
  dermis_frame cut = bound_frame(graph);
  cut.flags |= DERMIS_FRAME_RESET_HISTORY;
  EXPECT_EQ(record_and_read(graph, cut).probed_tiles, 1u);
  for (int i = 1; i < 16; ++i)
    EXPECT_EQ(run_frame(checks).probed_tiles, 1u) << i;
}

// The table holds the error of a technique whose histories have converged.
TEST_F(Probe, FirstFramesOfAHistory_AreNoErrorOfTheTechnique) {
  const auto predictions = [&](const char* technique) {
    last_frame = 0; // Each frame number has its tiles.
    make(technique);
    set("history", "\"camera\"");
    set_budget(1000);
    make_images(graph);
    std::vector<double> predicted;
    for (int i = 0; i < 40; ++i)
      predicted.push_back(run_frame(checks).predicted_rmse);
    return predicted;
  };
  const std::vector<double> light = predictions("\"off\""), afis = predictions("\"afis\"");
  // Both follow the light, which is the same.
  const auto factor = [&](int frame) { return afis[frame] / light[frame]; };
  for (int i = 3; i < 15; ++i)
    EXPECT_NEAR(factor(i), factor(2), 1e-3 * factor(2)) << i;
  EXPECT_GT(std::abs(std::log(factor(39) / factor(2))), 0.2) << "then its error is measured";
}

TEST_F(Probe, OverlayProbesOtherGraphs) {
  GraphOptions options = shipped_options("configs/graphs/sap.json");
  options.overlays = {read_text("configs/overlays/probe.json")};
  graph = make_graph(options);
  make_images(graph);
  EXPECT_EQ(run_frame(spread).probed_tiles, 1u);
}

TEST_F(Probe, DoesNotChangeThePicture) {
  make("\"sap\"");
  run_frame(spread);
  const auto probed = texels("lighting");
  make("\"sap\"", false);
  run_frame(spread);
  EXPECT_EQ(texels("lighting"), probed);
}

} // namespace
} // namespace dermis::abi_test
