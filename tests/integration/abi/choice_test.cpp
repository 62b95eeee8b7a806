// Tests budgets: the chosen configuration, its effect on the picture, and the report.

#include "integration/examples/demo_engine/render/reported_frame.hpp"
#include "tests/integration/abi/dermis_fixture.hpp"
#include "tests/integration/abi/invented_times.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::abi_test {
namespace {

struct Choice : DermisTest {
  dermis_graph graph = nullptr;

  void make() { graph = make_bound_graph(shipped_options("configs/graphs/skin.json")); }

  void set_budget(float ms, uint32_t flags = DERMIS_BUDGET_DETERMINISTIC) {
    const std::string text = invented_times;
    const dermis_source calibration = source_of(text, "invented");
    dermis_budget budget = budget_of(ms, flags);
    budget.calibration = &calibration;
    dermis_report report = nullptr;
    ASSERT_OK(dermis_graph_set_budget(graph, &budget, &report)) << take(report).all;
    dermis_report_destroy(report);
  }

  demo::ReportedFrame run_frame() { return DermisTest::run_frame(graph); }

  std::string exported() const {
    size_t size = 0;
    EXPECT_OK(dermis_graph_calibration(graph, &size, nullptr));
    std::string text(size, ' ');
    EXPECT_OK(dermis_graph_calibration(graph, &size, text.data()));
    text.resize(size - 1);
    return text;
  }
};

TEST_F(Choice, WithoutABudgetTheDefaultsRun) {
  make();
  const demo::ReportedFrame choice = run_frame();
  EXPECT_STREQ(choice.configuration, "technique=sap, variant=smooth");
  EXPECT_STREQ(choice.technique, "sap smooth");
  EXPECT_EQ(choice.budget_ms, 0);
  // sap has three variants, hybrid two, separable three numbers of taps; afis, partial, off
  EXPECT_EQ(choice.configuration_count, 11u);
}

TEST_F(Choice, EachBudgetGetsTheSmallestErrorThatFits) {
  make();
  std::string before;
  for (const float budget : {30.0f, 5.0f, 0.5f}) {
    set_budget(budget);
    const demo::ReportedFrame choice = run_frame();
    if (budget > 1) {
      EXPECT_LE(choice.predicted_ms, budget);
    }
    EXPECT_NE(choice.configuration, before) << budget; // a smaller budget leads elsewhere
    before = choice.configuration;
    EXPECT_EQ(choice.budget_ms, budget);
  }
  EXPECT_THAT(before, HasSubstr("technique=off")); // Nothing fits 0.5 ms: the fastest runs.
}

TEST_F(Choice, SettingsOfTheHostAreNotChosen) {
  make();
  ASSERT_OK(dermis_graph_set_setting(graph, "technique", "\"separable\"", nullptr));
  make_images(graph);
  for (const float budget : {30.0f, 0.5f}) {
    set_budget(budget);
    const demo::ReportedFrame choice = run_frame();
    EXPECT_THAT(choice.configuration, HasSubstr("technique=separable")) << budget;
    EXPECT_EQ(choice.configuration_count, 3u); // the taps are still open
  }
}

// The default technique has no history, so the plan of the first configuration stays the same.
TEST_F(Choice, SettingOfAnotherConfiguration_TakesEffect) {
  make();
  const uint64_t with = memory_of(graph).history_bytes;
  ASSERT_OK(dermis_graph_set_setting(graph, "history", "\"off\"", nullptr));
  EXPECT_LT(memory_of(graph).history_bytes, 0.7 * double(with));
}

TEST_F(Choice, SlotsOfOtherConfigurations_HaveTheirLayout) {
  make();
  for (const dermis_slot& slot : slots_of(graph))
    if (slot.read == 1 && slot.written == 0) {
      EXPECT_EQ(slot.best_layout, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL) << slot.name;
    }
}

TEST_F(Choice, DiscardAfterNewTables_NamesTheRightTechnique) {
  make();
  ASSERT_OK(dermis_graph_set_setting(graph, "technique", "\"separable\"", nullptr));
  make_images(graph);
  for (int i = 0; i < 3; ++i)
    run_frame();
  ASSERT_OK(reload_graph(graph, shipped_options("configs/graphs/skin.json")));
  dermis_frame discarded = bound_frame(graph);
  record_unsubmitted(graph, discarded); // The new graph takes over.
  const std::string table = R"({ "dermis_errors": 2, "scenes": "invented",
    "unscattered": [[1, 0.001]], "techniques": [{ "name": "only", "rmse": [[1, 0.003]],
    "pass_types": [{ "type": "subsurface.separable" }] }] })";
  const dermis_source errors = source_of(table, "invented");
  dermis_budget budget = budget_of(0, 0);
  budget.errors = &errors;
  ASSERT_OK(dermis_graph_set_budget(graph, &budget, nullptr));
  ASSERT_OK(dermis_view_discard(dermis_graph_view(graph), discarded.frame_index));
  demo::ReportedFrame found;
  ASSERT_OK(demo::read_reported(dermis_graph_view(graph), discarded.frame_index - 1, found));
  EXPECT_STREQ(found.technique, "only");
}

TEST_F(Choice, TimesAreThoseOfTheNewestCompletedFrame) {
  make();
  set_budget(30);
  run_frame();
  const uint64_t first = last_frame;
  const auto newest = [&](uint64_t completed) {
    uint32_t count = 0;
    EXPECT_OK(dermis_view_timings(dermis_graph_view(graph), completed, &count, nullptr));
    std::vector<dermis_pass_timing> times(count, dermis_pass_timing DERMIS_PASS_TIMING_INIT);
    EXPECT_OK(dermis_view_timings(dermis_graph_view(graph), completed, &count, times.data()));
    return times.empty() ? 0 : times.front().frame_index;
  };
  EXPECT_EQ(newest(first), first);
  set_budget(0.5f); // another plan
  run_frame();
  EXPECT_EQ(newest(first), first);
  EXPECT_EQ(newest(last_frame), last_frame);
}

TEST_F(Choice, SwitchingPlans_ShowsTheRunningPlansPicture) {
  make();
  const auto picture = [&] {
    make_images(graph);
    run_frame();
    return texels("lighting");
  };
  set_budget(0);
  const auto sap = picture();
  set_budget(0.5f);
  const auto off = picture();
  set_budget(0);
  const auto again = picture();
  EXPECT_NE(sap, off);
  EXPECT_EQ(sap, again); // The validation layer has checked the memory that both plans share.
}

TEST_F(Choice, SwitchingEveryFrame_KeepsMemoryIntact) {
  make();
  set_budget(0);
  const auto sap = [&] {
    make_images(graph);
    run_frame();
    return texels("lighting");
  }();
  for (int i = 0; i < 12; ++i) {
    set_budget(i % 2 == 0 ? 0.5f : 0.0f);
    make_images(graph);
    run_frame();
  }
  EXPECT_EQ(texels("lighting"), sap);
}

struct KeptHistory : Choice {
  // Makes a graph that accumulates light of both techniques: its history is one resource in both
  // plans.
  void make_accumulating() {
    GraphOptions options = shipped_options("configs/graphs/skin.json");
    options.overlays = {read_text("configs/overlays/accumulate.json")};
    options.unbound.emplace_back("velocity");
    graph = make_graph(options);
    ASSERT_OK(dermis_graph_set_setting(graph, "accumulate_clip", "0", nullptr));
    make_images(graph);
  }
  // One frame lit from one side, because light that is the same everywhere is copied. Two pixels in
  // the middle are brighter by `spot`, which scattering blurs and copying leaves: what history
  // keeps shows which ran.
  demo::ReportedFrame lit_frame(float spot, uint32_t flags = 0) {
    fill("lighting", [&](uint32_t x, uint32_t y) {
      return 0.75f + 0.5f * (float(x) + 0.5f) / 64 +
             (y == 32 && (x == 31 || x == 32) ? spot : 0.0f);
    });
    dermis_frame one = bound_frame(graph);
    one.flags |= flags;
    rest(one);
    return record_and_read(graph, one);
  }
  float middle() {
    const auto light = texels("lighting");
    return (light[4 * (64 * 32 + 31)] + light[4 * (64 * 32 + 32)]) / 2;
  }
  // Returns the middle pixel's light in a frame without history: scattered, and copied.
  std::pair<float, float> levels() {
    set_budget(0);
    lit_frame(1, DERMIS_FRAME_RESET_HISTORY);
    const float scattered = middle();
    set_budget(0.5f);
    lit_frame(1, DERMIS_FRAME_RESET_HISTORY);
    return {scattered, middle()};
  }
};

TEST_F(KeptHistory, NextPlan_ReadsHistoryOfPreviousPlan) {
  make_accumulating();
  const auto [scattered, copied] = levels();
  EXPECT_GT(copied, scattered + 0.3f);
  // The light around the spot differs a little between the two techniques.
  const float tolerance = 0.02f * (copied - scattered);
  set_budget(0);
  lit_frame(1, DERMIS_FRAME_RESET_HISTORY);
  for (int i = 0; i < 3; ++i)
    lit_frame(1);
  EXPECT_NEAR(middle(), scattered, 2e-3);
  set_budget(0.5f); // too little for the pyramid
  const demo::ReportedFrame switched = lit_frame(1);
  EXPECT_THAT(switched.configuration, HasSubstr("technique=off"));
  EXPECT_EQ(switched.skips & DERMIS_SKIP_HISTORY, 0u);
  EXPECT_NEAR(middle(), (4 * scattered + copied) / 5, tolerance); // The mean of five frames.
  set_budget(0);
  const demo::ReportedFrame back = lit_frame(1);
  EXPECT_THAT(back.configuration, HasSubstr("technique=sap"));
  EXPECT_EQ(back.skips & DERMIS_SKIP_HISTORY, 0u);
  EXPECT_NEAR(middle(), (5 * scattered + copied) / 6,
              tolerance); // This differs from what this plan stored four frames ago.
}

TEST_F(KeptHistory, CutInTheSwitchingFrame_ResetsHistory) {
  make_accumulating();
  const float copied = levels().second;
  set_budget(0);
  for (int i = 0; i < 4; ++i)
    lit_frame(1);
  set_budget(0.5f);
  const demo::ReportedFrame switched = lit_frame(1, DERMIS_FRAME_RESET_HISTORY);
  EXPECT_NE(switched.skips & DERMIS_SKIP_HISTORY, 0u);
  EXPECT_NEAR(middle(), copied, 2e-3);
}

TEST_F(KeptHistory, ReloadedGraph_ReadsItsHistory) {
  const std::string text = read_text("configs/graphs/skin.json");
  make_accumulating();
  set_budget(0);
  const auto run = [&](bool reload) {
    lit_frame(2, DERMIS_FRAME_RESET_HISTORY);
    for (int i = 0; i < 6; ++i) {
      if (reload && i % 2 == 0) {
        EXPECT_OK(reload_text(graph, source_of(text, "skin.json")));
      }
      EXPECT_EQ(lit_frame(float(i + 1) / 8).skips & DERMIS_SKIP_HISTORY, 0u) << "frame " << i;
    }
    return texels("lighting");
  };
  const auto steady = run(false);
  EXPECT_EQ(run(true), steady) << "bit by bit";
}

TEST_F(KeptHistory, SwitchingEveryFrameKeepsAllFrames) {
  make_accumulating();
  const auto [scattered, copied] = levels();
  set_budget(0);
  lit_frame(1, DERMIS_FRAME_RESET_HISTORY);
  for (int i = 0; i < 8; ++i) {
    set_budget(i % 2 == 0 ? 0.5f : 0.0f);
    lit_frame(1);
  }
  EXPECT_NEAR(middle(), (5 * scattered + 4 * copied) / 9, 0.02f * (copied - scattered));
}

TEST_F(Choice, ReportsTilesAndScatteringDistance) {
  make();
  const demo::ReportedFrame choice = run_frame();
  EXPECT_EQ(choice.view_tiles, 64u); // 64x64 pixels
  EXPECT_EQ(choice.scattering_tiles, 64u);
  EXPECT_EQ(choice.copied_tiles, 0u);
  // Skin's widest d is 1.04 mm and a pixel is 0.5 mm; a step of the counter is 1/16 of an octave.
  EXPECT_NEAR(std::log2(choice.mean_d_px), std::log2(3.67 / 3.5 / 0.5), 1.0 / 16);
}

TEST_F(Choice, LearnsAndExportsTheDevicesTimes) {
  make();
  set_budget(0, 0);
  for (int i = 0; i < 8; ++i)
    run_frame();
  size_t size = 0;
  ASSERT_OK(dermis_graph_calibration(graph, &size, nullptr));
  std::string text(size, ' ');
  size_t small = 3;
  EXPECT_EQ(dermis_graph_calibration(graph, &small, text.data()), DERMIS_INCOMPLETE);
  ASSERT_OK(dermis_graph_calibration(graph, &size, text.data()));
  text.resize(size - 1);
  EXPECT_THAT(text, HasSubstr("subsurface.sap_gather variant=smooth storage=half"));
  const dermis_source calibration = source_of(text, "learned");
  dermis_budget budget = DERMIS_BUDGET_INIT;
  budget.calibration = &calibration;
  EXPECT_OK(dermis_graph_set_budget(graph, &budget, nullptr));
}

TEST_F(Choice, ExportedTimesOfAllPasses_AreCertain) {
  graph = make_bound_graph(); // one configuration
  set_budget(0, 0);
  EXPECT_THAT(exported(), HasSubstr("\"uncertainty\": 3.3"));
  for (int i = 0; i < 3; ++i)
    run_frame();
  EXPECT_THAT(exported(), HasSubstr("\"uncertainty\": 1.35"));
}

TEST_F(Choice, ExportedTimesOfOneConfiguration_AreUncertain) {
  make();
  set_budget(0, 0);
  for (int i = 0; i < 3; ++i)
    run_frame();
  EXPECT_THAT(exported(), HasSubstr("\"uncertainty\": 3.3"));
}

TEST_F(Choice, FirstFrame_IsNotLearned) {
  graph = make_bound_graph();
  set_budget(0, 0);
  const std::string before = exported();
  run_frame();
  EXPECT_EQ(exported(), before);
  run_frame();
  EXPECT_NE(exported(), before);
}

TEST_F(Choice, FrameOfOldSettings_IsNotLearned) {
  graph = make_bound_graph();
  set_budget(0, 0);
  run_frame();
  const std::string before = exported();
  dermis_frame old = bound_frame(graph);
  ASSERT_OK(record(graph, old));
  ASSERT_OK(dermis_graph_set_setting(graph, "samples", "64", nullptr));
  demo::ReportedFrame report;
  ASSERT_OK(demo::read_reported(dermis_graph_view(graph), last_frame, report));
  EXPECT_EQ(exported(), before);
  run_frame();
  EXPECT_NE(exported(), before);
}

TEST_F(Choice, MarginOutlivesAReload) {
  constexpr double first = 0.10; // of a new graph
  const auto margin = [](const demo::ReportedFrame& frame) {
    return std::log1p(double(frame.predicted_margin_ms) / frame.predicted_ms);
  };
  graph = make_bound_graph();
  set_budget(0, 0);
  double last = first;
  // Times of frames decide how far the margin moves, usually far enough within a few frames.
  for (int i = 0; i < 100 && std::abs(last - first) < 0.005; ++i)
    last = margin(run_frame());
  ASSERT_OK(reload_graph(graph, {}));
  EXPECT_NEAR(margin(run_frame()), last, 0.03 * last); // one frame changes it by 3 % at most
}

TEST_F(Choice, ConfigurationsShareTheLargestMemory) {
  constexpr uint32_t side = 256; // smaller mips of afis have the size of this view
  GraphOptions every = shipped_options("configs/graphs/skin.json");
  every.width = every.height = side;
  const dermis_graph graph = make_graph(every);
  const dermis_memory all = memory_of(graph);
  uint64_t largest = 0;
  for (const dermis_outcome& one :
       list_of<dermis_outcome>(DERMIS_OUTCOME_INIT, dermis_graph_frontier, graph,
                               static_cast<const dermis_forecast_desc*>(nullptr)))
    largest = std::max(largest, one.transient_bytes + one.history_bytes);
  EXPECT_GE(all.transient_bytes + all.history_bytes, largest);
  EXPECT_LE(all.transient_bytes + all.history_bytes, largest + largest / 100); // alignment
}

TEST_F(Choice, UnfinishedFrame_IsNotReady) {
  make();
  demo::ReportedFrame choice;
  for (const uint64_t completed : {0, 5}) // none was recorded
    EXPECT_EQ(demo::read_reported(dermis_graph_view(graph), completed, choice), DERMIS_NOT_READY);
}

TEST_F(Choice, CompiledAgain_IsNotReadyFromItsFirstRecordOn) {
  make();
  run_frame();
  demo::ReportedFrame choice;
  const dermis_view view = dermis_graph_view(graph);
  ASSERT_OK(dermis_graph_set_setting(graph, "technique", "\"separable\"", nullptr));
  ASSERT_OK(demo::read_reported(view, last_frame, choice)) << "of the graph before";
  make_images(graph);
  dermis_frame frame = bound_frame(graph);
  record_unsubmitted(graph, frame);
  EXPECT_EQ(demo::read_reported(view, last_frame, choice), DERMIS_NOT_READY);
  ASSERT_OK(dermis_view_discard(view, frame.frame_index));
}

TEST_F(Choice, WrongBudgetsAreRejectedAndChangeNothing) {
  make();
  set_budget(30);
  dermis_budget budget = DERMIS_BUDGET_INIT;
  for (const float ms : {-1.0f, std::nanf(""), INFINITY}) {
    budget.milliseconds = ms;
    EXPECT_EQ(dermis_graph_set_budget(graph, &budget, nullptr), DERMIS_ERROR_ARGUMENT) << ms;
  }
  budget.milliseconds = 1;
  for (const uint32_t flags : {16u, DERMIS_BUDGET_TRIALS_AT_CUTS | DERMIS_BUDGET_NO_TRIALS}) {
    budget.flags = flags;
    EXPECT_EQ(dermis_graph_set_budget(graph, &budget, nullptr), DERMIS_ERROR_ARGUMENT) << flags;
  }
  budget.flags = 0;
  for (const float percentile : {0.4f, 0.999f, -1.0f, std::nanf("")}) {
    budget.percentile = percentile;
    EXPECT_EQ(dermis_graph_set_budget(graph, &budget, nullptr), DERMIS_ERROR_ARGUMENT)
        << percentile;
  }
  budget.percentile = 0;
  for (const float uncertainty : {0.5f, 101.0f, std::nanf("")}) {
    budget.uncertainty = uncertainty;
    EXPECT_EQ(dermis_graph_set_budget(graph, &budget, nullptr), DERMIS_ERROR_ARGUMENT)
        << uncertainty;
  }
  budget.uncertainty = 0;
  const std::string text =
      "{ \"dermis_errors\": 2,\n \"scenes\": \"s\", \"unscatterd\": [[1, 1]], \"techniques\": [] }";
  const dermis_source errors = source_of(text, "errors.json");
  budget.errors = &errors;
  dermis_report report = nullptr;
  EXPECT_EQ(dermis_graph_set_budget(graph, &budget, &report), DERMIS_ERROR_CONFIG);
  const Said said = take(report);
  ASSERT_EQ(said.places.size(), 1u) << said.all;
  EXPECT_EQ(said.places[0].first, 2u);
  EXPECT_EQ(run_frame().budget_ms, 30);
}

} // namespace
} // namespace dermis::abi_test
