// Frames that are recorded, never submitted and discarded do not affect anything that follows.

#include "integration/examples/demo_engine/render/reported_frame.hpp"
#include "tests/integration/abi/dermis_fixture.hpp"
#include "tests/integration/abi/invented_times.hpp"
#include "tests/integration/embedding/null_host.hpp"

#include <algorithm>

namespace dermis::abi_test {
namespace {

// One frame as a host describes it.
struct Shot {
  std::array<uint32_t, 4> rectangle{}; // x, y, width, height; zeros: all of the images.
  std::array<float, 2> jitter{};
  float light = 1, budget_ms = 0, seconds = 1.0f / 60;
  uint32_t flags = 0;
};

// Everything that a host can observe after a frame.
struct Seen {
  std::vector<float> lighting;
  std::string choice, histories;
  bool operator==(const Seen&) const = default;
};

std::string text_of(const demo::ReportedFrame& choice) {
  std::ostringstream text;
  text << choice.frame_index << ": " << choice.configuration << "; " << choice.reason << "; "
       << choice.switches << " switches, " << choice.budget_ms << " ms, predicted "
       << choice.predicted_ms << ", deterministic " << choice.calibrated_ms << ", rmse "
       << choice.predicted_rmse << ", skips " << choice.skips << ", tiles "
       << choice.scattering_tiles << " of " << choice.view_tiles << ", groups " << choice.groups
       << ", units " << choice.sample_units;
  return text.str();
}

std::string histories_of(dermis_graph graph) {
  const auto histories =
      list_of(dermis_history DERMIS_HISTORY_INIT, dermis_view_histories, dermis_graph_view(graph));
  std::ostringstream text;
  for (const dermis_history& one : histories)
    text << one.name << " valid " << one.valid << ", age " << one.age << ", reason " << one.reason
         << " (" << one.text << "); ";
  return text.str();
}

struct Discard : DermisTest {
  dermis_graph graph = nullptr;

  void make(const char* of = "configs/graphs/skin.json") {
    GraphOptions options = shipped_options(of);
    options.overlays = {read_text("configs/overlays/accumulate.json")};
    graph = make_bound_graph(options);
    last_frame = 0;
    const std::string text = invented_times;
    const dermis_source calibration = source_of(text, "invented");
    dermis_budget budget = DERMIS_BUDGET_INIT;
    budget.flags = DERMIS_BUDGET_DETERMINISTIC;
    budget.calibration = &calibration;
    ASSERT_OK(dermis_graph_set_budget(graph, &budget, nullptr));
  }

  void set_budget(float ms) {
    dermis_budget budget = budget_of(ms, DERMIS_BUDGET_DETERMINISTIC);
    ASSERT_OK(dermis_graph_set_budget(graph, &budget, nullptr));
  }

  dermis_frame frame_of(const Shot& shot, const std::vector<dermis_image_binding>& bound) {
    dermis_frame one = frame(bound);
    one.rect_x = shot.rectangle[0];
    one.rect_y = shot.rectangle[1];
    one.rect_width = shot.rectangle[2];
    one.rect_height = shot.rectangle[3];
    one.jitter_x = shot.jitter[0];
    one.jitter_y = shot.jitter[1];
    one.delta_seconds = shot.seconds;
    one.flags = shot.flags;
    rest(one);
    return one;
  }

  Seen submit(const Shot& shot) {
    set_budget(shot.budget_ms);
    fill("lighting", [&](uint32_t x, uint32_t y) {
      return shot.light * float(16 + (x * 7 + y * 3) % 32) / 32;
    });
    const auto bound = bindings(graph);
    dermis_frame one = frame_of(shot, bound);
    const demo::ReportedFrame choice = record_and_read(graph, one);
    return {texels("lighting"), text_of(choice), histories_of(graph)};
  }

  void discard(const Shot& shot) {
    set_budget(shot.budget_ms);
    const auto bound = bindings(graph);
    dermis_frame one = frame_of(shot, bound);
    record_unsubmitted(graph, one);
    EXPECT_OK(dermis_view_discard(dermis_graph_view(graph), one.frame_index));
  }
};

constexpr std::array<uint32_t, 4> small_rectangle = {9, 5, 30, 41},
                                  other_rectangle = {16, 0, 44, 29};

// Rectangles, jitter, cuts, budgets and times between frames all change, in kept and in discarded
// frames. The discarded frames include the first frame of the graph, of a plan, and of a reloaded
// and a resized graph.
TEST_F(Discard, LeavesNoVisibleTrace) {
  const std::string text = read_text("configs/graphs/skin.json");
  constexpr uint32_t frames = 24;
  const auto shot_of = [](uint32_t i) {
    return Shot{.rectangle = i % 5 == 4 ? std::array<uint32_t, 4>{} : small_rectangle,
                .jitter = {0.25f * float(i % 3) - 0.25f, 0.125f * float(i % 2)},
                .light = 0.5f + 0.03f * float(i),
                .budget_ms = i / 4 % 3 == 1 ? 0.5f : 30.0f,
                .seconds = 0.2f,
                .flags = i == 10 ? uint32_t{DERMIS_FRAME_RESET_HISTORY} : 0u};
  };
  const auto lost_shot_of = [](uint32_t i) {
    return Shot{.rectangle = i % 3 == 0 ? std::array<uint32_t, 4>{} : other_rectangle,
                .jitter = {-0.375f, 0.375f},
                .budget_ms = i % 2 == 0 ? 0.5f : 30.0f,
                .seconds = 1.5f,
                .flags = i % 4 == 1 ? uint32_t{DERMIS_FRAME_RESET_HISTORY} : 0u};
  };
  const auto run = [&](bool lossy) {
    make();
    std::vector<Seen> seen;
    for (uint32_t i = 0; i < frames; ++i) {
      if (i == 8 || i == 20) {
        EXPECT_OK(reload_text(graph, source_of(text, "skin.json"), nullptr));
      }
      if (i == 14) {
        EXPECT_OK(dermis_graph_resize(graph, 72, 60, nullptr));
        make_images(graph);
      }
      for (uint32_t lost = 0; lossy && lost < 1 + i % 2; ++lost)
        discard(lost_shot_of(i + lost));
      seen.push_back(submit(shot_of(i)));
    }
    return seen;
  };
  const std::vector<Seen> expected = run(false), found = run(true);
  ASSERT_EQ(expected.size(), found.size());
  for (uint32_t i = 0; i < frames; ++i) {
    EXPECT_EQ(expected[i].choice, found[i].choice) << "frame " << i;
    EXPECT_EQ(expected[i].histories, found[i].histories) << "frame " << i;
    EXPECT_TRUE(expected[i].lighting == found[i].lighting) << "frame " << i << ", bit by bit";
  }
}

TEST_F(Discard, RestoresThePreviousRectangle) {
  const auto run = [&](bool lossy) {
    make("configs/graphs/burley.json");
    submit({.rectangle = small_rectangle, .light = 0.25f});
    if (lossy) discard({.rectangle = other_rectangle});
    return submit({.rectangle = small_rectangle, .light = 1});
  };
  const Seen expected = run(false);
  EXPECT_TRUE(run(true).lighting == expected.lighting)
      << "the history keeps the previous frame's rectangle";
}

// After two switches the third waits for two seconds; the time of a discarded frame must not count.
TEST_F(Discard, RestoresTheLastDecision) {
  const auto run = [&](const std::vector<Shot>& lost) {
    make();
    std::vector<std::string> choices;
    for (int i = 0; i < 40; ++i) // until the first seconds are over
      submit({.budget_ms = 30, .seconds = 0.1f});
    for (const float budget : {30.0f, 0.5f})
      choices.push_back(submit({.budget_ms = budget, .seconds = 0.1f}).choice);
    for (const Shot& shot : lost)
      discard(shot);
    for (uint32_t i = 0; i < 12; ++i)
      choices.push_back(submit({.budget_ms = 30, .seconds = 0.2f}).choice);
    return choices;
  };
  const std::vector<std::string> expected = run({});
  EXPECT_THAT(expected[2], HasSubstr("kept, to switch less often"));
  EXPECT_THAT(expected.back(), Not(HasSubstr("kept, to switch less often")));
  EXPECT_EQ(run({{.budget_ms = 0.5f, .seconds = 5}}), expected)
      << "the time of the discarded frame";
  EXPECT_EQ(run({{.budget_ms = 0.5f, .seconds = 5}, {.budget_ms = 0.5f, .seconds = 5}}), expected)
      << "two consecutive frames";
  EXPECT_EQ(run({{.budget_ms = 0.4f, .seconds = 0.1f}}), expected)
      << "the choice of the discarded frame";
}

TEST_F(Discard, LeavesNoTimes) {
  make("configs/graphs/burley.json");
  for (int i = 0; i < 4; ++i)
    submit({});
  discard({}); // Frame 5 uses the queries of frame 3.
  const auto bound = bindings(graph);
  dermis_frame next = frame_of({}, bound);
  next.frame_index = 6;
  ASSERT_OK(record(graph, next));
  std::vector<dermis_pass_timing> times(64, dermis_pass_timing DERMIS_PASS_TIMING_INIT);
  auto count = static_cast<uint32_t>(times.size());
  const dermis_result result =
      dermis_view_timings(dermis_graph_view(graph), 5, &count, times.data());
  EXPECT_TRUE(result == DERMIS_NOT_READY || (result == DERMIS_OK && times[0].frame_index <= 4))
      << result << ": times of frame " << times[0].frame_index << ", which never ran";
  demo::ReportedFrame choice;
  ASSERT_OK(demo::read_reported(dermis_graph_view(graph), 5, choice));
  EXPECT_EQ(choice.frame_index, 4u);
  ASSERT_OK(dermis_view_timings(dermis_graph_view(graph), 6, &count, times.data()));
  EXPECT_EQ(times[0].frame_index, 6u);
}

// Times of a plan's first frame are not learned, because a driver may create pipelines in it. The
// null device reports 0 for each pass, so learned times show at once.
TEST(DiscardOnANullDevice, NextFrameIsStillThePlansFirst) {
  const auto learned = [](bool lossy) {
    NullHost host;
    EXPECT_OK(host.make_context(host.context_desc()));
    EXPECT_OK(host.make_graph());
    host.make_bindings();
    if (lossy) {
      EXPECT_OK(host.record());
      EXPECT_OK(dermis_view_discard(dermis_graph_view(host.graph), host.last_frame));
      --host.last_frame;
    }
    EXPECT_OK(host.record());
    demo::ReportedFrame choice;
    EXPECT_OK(demo::read_reported(dermis_graph_view(host.graph), host.last_frame, choice));
    std::string text(1 << 16, ' ');
    size_t size = text.size();
    EXPECT_OK(dermis_graph_calibration(host.graph, &size, text.data()));
    text.resize(size - 1);
    return text;
  };
  EXPECT_TRUE(learned(true) == learned(false)) << "the calibrations differ";
}

} // namespace
} // namespace dermis::abi_test
