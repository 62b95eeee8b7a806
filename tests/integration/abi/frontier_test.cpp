// Tests the forecasts for the host: what each configuration takes, and what a budget would choose
// at another resolution. Calibrated times make them equal on every machine.

#include "integration/examples/demo_engine/render/reported_frame.hpp"
#include "tests/integration/abi/dermis_fixture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

namespace dermis::abi_test {
namespace {

struct Extent {
  uint32_t width = 0, height = 0;
};

constexpr Extent allocated = {320, 192};
// of the render rectangle
constexpr std::pair<Extent, Extent> changes[] = {{allocated, allocated},  {allocated, {240, 144}},
                                                 {allocated, {160, 96}},  {{160, 96}, allocated},
                                                 {{160, 96}, {256, 192}}, {{256, 192}, {160, 96}}};
constexpr double tolerance = 0.10; // of calibrated times

struct Frontier : DermisTest {
  dermis_graph graph = nullptr;

  void make() {
    GraphOptions options = shipped_options("configs/graphs/skin.json");
    options.width = allocated.width;
    options.height = allocated.height;
    graph = make_graph(options);
    // Measured errors change between a prediction and its frame.
    ASSERT_OK(dermis_graph_set_setting(graph, "probe", "\"off\"", nullptr));
    make_images(graph);
  }
  void set_budget(float ms) const {
    const dermis_budget budget = budget_of(ms, DERMIS_BUDGET_DETERMINISTIC);
    ASSERT_OK(dermis_graph_set_budget(graph, &budget, nullptr));
  }
  // Draws a disc of skin in uneven light, the same picture at any resolution.
  void draw(Extent size) {
    const double unit = double(size.height) / 2;
    fill("material", [&](uint32_t x, uint32_t y) {
      const double u = (x + 0.5 - double(size.width) / 2) / unit, v = (y + 0.5) / unit - 1;
      return u * u + v * v < 0.6 ? 1.0f : 0.0f;
    });
    fill("lighting", [&](uint32_t x, uint32_t y) {
      return float(0.5 + 0.4 * std::sin(13.0 * x / unit) * std::sin(11.0 * y / unit));
    });
  }
  // Records `frames` frames of the size, a minute apart, so that no configuration is in its
  // back-off; returns the last one's report.
  demo::ReportedFrame run(Extent size, int frames) {
    demo::ReportedFrame newest;
    for (int i = 0; i < frames; ++i) {
      dermis_frame one = bound_frame(graph, allocated.width, allocated.height);
      one.rect_width = size.width;
      one.rect_height = size.height;
      one.delta_seconds = 60;
      rest(one);
      newest = record_and_read(graph, one);
    }
    return newest;
  }
  dermis_outcome predict(Extent size, float ms = 0) const {
    dermis_forecast_desc desc = DERMIS_FORECAST_DESC_INIT;
    desc.width = size.width;
    desc.height = size.height;
    desc.milliseconds = ms;
    dermis_outcome outcome = DERMIS_OUTCOME_INIT;
    EXPECT_OK(dermis_graph_predict(graph, &desc, &outcome));
    return outcome;
  }
  struct Prediction {
    std::string configuration;
    float ms, rmse;
  };
  // Predictions for the budget and for others near it. A running configuration is left at 0.97 of
  // the budget and entered at 0.92, so two configurations can be right between, and predicted times
  // differ from calibrated ones by about 1 %.
  std::vector<Prediction> predictions_near(Extent size, float budget) const {
    std::vector<Prediction> found;
    for (const float factor : {1.0f, 0.94f, 0.98f, 1.02f}) {
      const dermis_outcome one = predict(size, factor * budget);
      found.push_back({one.configuration, one.expected_ms, one.expected_rmse});
    }
    return found;
  }
  std::vector<dermis_outcome> frontier(const dermis_forecast_desc* desc = nullptr) const {
    return list_of<dermis_outcome>(DERMIS_OUTCOME_INIT, dermis_graph_frontier, graph, desc);
  }
  // Makes the library's choices by hand: "technique=sap, variant=base".
  void pin(std::string configuration) const {
    for (size_t at = 0; at < configuration.size();) {
      const size_t equals = configuration.find('=', at);
      const size_t end = std::min(configuration.find(',', at), configuration.size());
      const std::string name = configuration.substr(at, equals - at),
                        json = "\"" + configuration.substr(equals + 1, end - equals - 1) + "\"";
      ASSERT_OK(dermis_graph_set_setting(graph, name.c_str(), json.c_str(), nullptr)) << name;
      at = end + 2;
    }
  }
};

TEST_F(Frontier, Predictions_MatchTheMeterWithinTenPercent) {
  make();
  set_budget(0);
  draw(allocated);
  run(allocated, 2);
  std::set<std::string> chosen;
  for (const dermis_outcome& one : frontier()) {
    if (one.dominated != 0) continue;
    // enough for this configuration at the allocated size, and for others at smaller ones
    const float budget = 1.15f * one.expected_ms;
    for (const auto& [from, to] : changes) {
      set_budget(budget);
      draw(from);
      run(from, 4);
      const std::vector<Prediction> predictions = predictions_near(to, budget);
      draw(to);
      const demo::ReportedFrame frame = run(to, 6);
      const std::string at = fmt::format("{} ms, from {}x{} to {}x{}: {}", budget, from.width,
                                         from.height, to.width, to.height, frame.configuration);
      const auto right = std::find_if(predictions.begin(), predictions.end(), [&](const auto& one) {
        return one.configuration == frame.configuration;
      });
      ASSERT_NE(right, predictions.end()) << at << "; predicted " << predictions[0].configuration;
      EXPECT_NEAR(right->ms, frame.calibrated_ms, tolerance * frame.calibrated_ms) << at;
      EXPECT_NEAR(right->rmse, frame.predicted_rmse, tolerance * frame.predicted_rmse) << at;
      chosen.insert(frame.configuration);
    }
  }
  EXPECT_GE(chosen.size(), 3u);
}

TEST_F(Frontier, EachConfiguration_TakesWhatIsExpected) {
  make();
  set_budget(1e4f); // samples everywhere, so that the demand is known
  draw(allocated);
  run(allocated, 3);
  const std::vector<dermis_outcome> outcomes = frontier();
  EXPECT_GE(outcomes.size(), 9u);
  std::vector<std::string> names; // set_setting ends the life of the texts
  for (const dermis_outcome& one : outcomes)
    names.emplace_back(one.configuration);
  set_budget(0); // pinned settings run
  for (size_t i = 0; i < names.size(); ++i) {
    pin(names[i]);
    const demo::ReportedFrame frame = run(allocated, 2);
    EXPECT_EQ(frame.configuration, names[i]);
    EXPECT_NEAR(outcomes[i].expected_ms, frame.calibrated_ms, tolerance * frame.calibrated_ms)
        << names[i];
    const dermis_memory memory = memory_of(graph);
    EXPECT_LE(outcomes[i].transient_bytes + outcomes[i].history_bytes,
              memory.transient_bytes + memory.history_bytes)
        << names[i];
  }
}

TEST_F(Frontier, DominatedOnes_AreNeitherFasterNorBetter) {
  make();
  set_budget(0);
  draw(allocated);
  run(allocated, 2);
  const std::vector<dermis_outcome> all = frontier();
  const auto dominates = [](const dermis_outcome& a, const dermis_outcome& b) {
    return a.expected_ms <= b.expected_ms && a.expected_rmse <= b.expected_rmse &&
           (a.expected_ms < b.expected_ms || a.expected_rmse < b.expected_rmse);
  };
  for (size_t i = 0; i < all.size(); ++i) {
    if (i > 0) {
      EXPECT_LE(all[i - 1].expected_ms, all[i].expected_ms);
    }
    EXPECT_GE(all[i].percentile_ms, all[i].expected_ms);
    EXPECT_EQ(all[i].fits, 1u) << "without a budget all fit";
    EXPECT_EQ(all[i].dominated != 0,
              std::any_of(all.begin(), all.end(),
                          [&](const dermis_outcome& one) { return dominates(one, all[i]); }))
        << all[i].configuration;
  }
}

TEST_F(Frontier, LargerBudgets_NeverPredictMoreError) {
  make();
  set_budget(0);
  draw(allocated);
  run(allocated, 2);
  const std::vector<dermis_outcome> all = frontier();
  float before = 1;
  for (double ms = 0.5 * double(all.front().expected_ms); ms < 2 * double(all.back().expected_ms);
       ms *= 1.1) {
    const dermis_outcome outcome = predict(allocated, static_cast<float>(ms));
    EXPECT_LE(outcome.expected_rmse, before) << ms;
    if (outcome.fits != 0) {
      EXPECT_LE(double(outcome.percentile_ms), 1.0001 * ms);
    }
    before = outcome.expected_rmse;
  }
  EXPECT_EQ(predict(allocated, 1e-3f).fits, 0u);
}

// Frames without a profile count no tiles, which says nothing about frames with one.
TEST_F(Frontier, FramesWithoutProfile_TellNothing) {
  make();
  set_budget(0);
  const dermis_outcome fresh = predict(allocated, 10);
  GraphOptions options = shipped_options("configs/graphs/skin.json");
  options.width = allocated.width;
  options.height = allocated.height;
  options.profiles = false;
  graph = make_graph(options);
  ASSERT_OK(dermis_graph_set_setting(graph, "probe", "\"off\"", nullptr));
  make_images(graph);
  set_budget(0);
  run(allocated, 3);
  const dermis_profile skin = skin_profile();
  ASSERT_OK(dermis_graph_set_profile(graph, 1, &skin.source, nullptr));
  const dermis_outcome later = predict(allocated, 10);
  EXPECT_STREQ(later.configuration, fresh.configuration);
  EXPECT_FLOAT_EQ(later.expected_ms, fresh.expected_ms);
}

// While light is off no tile scatters, but d and relief are those of the frames before.
TEST_F(Frontier, DarkFrames_KeepTheExpectedErrors) {
  make();
  draw(allocated);
  set_budget(0);
  run(allocated, 2);
  const dermis_outcome lit = predict(allocated, 1000);
  fill("lighting", [](uint32_t, uint32_t) { return 0.0f; });
  EXPECT_EQ(run(allocated, 2).scattering_tiles, 0u);
  const dermis_outcome dark = predict(allocated, 1000);
  // No tile requests samples, which reduce the error a little.
  EXPECT_NEAR(dark.expected_rmse / lit.expected_rmse, 1, 0.02);
}

// Relief is counted in half of the blocks of 32x32 pixels, so a small object may have none.
TEST_F(Frontier, SmallObjects_KeepTheKnownRelief) {
  make();
  draw(allocated);
  set_budget(0);
  run(allocated, 2);
  const dermis_outcome whole = predict(allocated, 1000);
  for (const uint32_t block : {0u, 1u}) {
    fill("material", [&](uint32_t x, uint32_t y) {
      return x / 8 == 4 * block + 1 && y / 8 == 1 ? 1.0f : 0.0f;
    });
    EXPECT_GT(run(allocated, 2).scattering_tiles, 0u);
    EXPECT_NEAR(predict(allocated, 1000).expected_rmse / whole.expected_rmse, 1, 0.1) << block;
  }
}

// A view in which nothing is shown leaves the budget to the others.
TEST_F(Frontier, ViewWithEmptyBounds_NeedsNoPart) {
  make();
  draw(allocated);
  const dermis_view other = view_of(graph);
  const dermis_budget budget = budget_of(20, DERMIS_BUDGET_DETERMINISTIC | DERMIS_BUDGET_ALL_VIEWS);
  ASSERT_OK(dermis_graph_set_budget(graph, &budget, nullptr));
  demo::ReportedFrame shown;
  for (int i = 0; i < 6; ++i) {
    dermis_frame one = bound_frame(graph, allocated.width, allocated.height);
    one.delta_seconds = 1;
    rest(one);
    shown = record_and_read(graph, one);
    dermis_frame empty = bound_frame(graph, allocated.width, allocated.height);
    empty.frame_index = shown.frame_index;
    empty.completed_frame_index = shown.frame_index - 1;
    empty.flags = DERMIS_FRAME_BOUNDS;
    rest(empty);
    const auto ran = demo::run_commands(*host, [&](VkCommandBuffer commands) -> demo::Result<> {
      empty.command_buffer = commands;
      EXPECT_OK(dermis_view_record(other, &empty));
      return demo::success();
    });
    ASSERT_TRUE(ran) << ran.error().text;
  }
  EXPECT_GT(shown.budget_ms, 0.95f * budget.milliseconds);
  dermis_view_destroy(other);
}

// The host keeps all passes of a frame within one budget by lowering its resolution. Its own passes
// take `others_ms` at the allocated size.
TEST_F(Frontier, Resolution_HoldsOneBudget) {
  make();
  draw(allocated);
  set_budget(0);
  run(allocated, 2);
  const double dermis_ms = double(frontier().back().expected_ms), others_ms = 2 * dermis_ms;
  const double frame_ms = 0.6 * (others_ms + dermis_ms);
  uint32_t percent = 100;
  for (int change = 0; change < 4; ++change) {
    Extent size;
    float budget = 0;
    for (percent = 100; percent > 40; percent -= 5) {
      size = {allocated.width * percent / 100, allocated.height * percent / 100};
      budget = static_cast<float>(frame_ms - others_ms * percent * percent / 1e4);
      if (budget <= 0) continue;
      const dermis_outcome outcome = predict(size, budget);
      if (outcome.fits != 0 && outcome.expected_rmse < 0.004f) break;
    }
    set_budget(budget);
    draw(size);
    const demo::ReportedFrame frame = run(size, 3);
    EXPECT_LE(double(frame.calibrated_ms) + others_ms * percent * percent / 1e4, 1.02 * frame_ms);
    EXPECT_LT(frame.predicted_rmse, 0.0044f);
  }
  EXPECT_GT(percent, 40u);
  EXPECT_LT(percent, 100u);
}

} // namespace
} // namespace dermis::abi_test
