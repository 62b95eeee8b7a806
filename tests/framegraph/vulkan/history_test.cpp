// Tests that a frame reads what the previous frame wrote, across submissions, and that age and
// validity are reported.
#include "tests/framegraph/vulkan/executor_fixture.hpp"

namespace dermis::testing {
namespace {

constexpr uint32_t side = 16;

// Computes count = count@-1 + 1 and copies it to `result`.
SmallGraph counter(uint32_t frames = 1) {
  SmallGraph g{"export result"};
  g.history("count", frames);
  g.set(g.pass("step", "test.add", {{"a", "count@-" + std::to_string(frames)}},
               {{"target", "count"}}),
        "bias", 1);
  g.pass("show", "test.add", {{"a", "count"}}, {{"target", "result"}});
  return g;
}

class HistoryTest : public ExecutorTest {};

TEST_F(HistoryTest, NewHistoryIsZero_FramesReadThePrevious) {
  const SmallGraph g = counter();
  const TestImage result = start(g, side, side);
  run_frames(5);
  EXPECT_THAT(read(result), Each(FloatEq(5.0f)));
}

TEST_F(HistoryTest, TwoFramesBack_ReadsTheRightFrame) {
  const SmallGraph g = counter(2); // Two interleaved counters.
  const TestImage result = start(g, side, side);
  expect_frames(result, {1, 1, 2, 2, 3, 3, 4});
}

// More instances than the descriptor sets of a pass have phases.
TEST_F(HistoryTest, EightFramesBack_ReadsTheRightFrame) {
  const SmallGraph g = counter(8);
  const TestImage result = start(g, side, side);
  expect_frames(result, {1, 1, 1, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2, 2, 2, 2, 3});
}

TEST_F(HistoryTest, UpdatedInPlace_CountsAndRestartsAfterACut) {
  SmallGraph g{"export result", "history count", "image copy"};
  g.pass("look", "test.add", {{"a", "count@-1"}}, {{"target", "copy"}});
  g.set(g.pass("step", "test.add", {{"a", "copy"}}, {{"target", "count"}}), "bias", 1);
  g.pass("show", "test.add", {{"a", "count"}}, {{"target", "result"}});
  const TestImage result = start(g, side, side);
  run_frames(4);
  EXPECT_THAT(read(result), Each(FloatEq(4.0f)));
  ASSERT_FALSE(frame(0.0f, {}, true));
  EXPECT_THAT(read(result), Each(FloatEq(1.0f)));
}

TEST_F(HistoryTest, InvalidHistory_PortReadsItsOtherwise) {
  SmallGraph g{"export result", "history count", "image start"};
  g.set(g.pass("begin", "test.fill", {}, {{"target", "start"}}), "value", 10);
  g.set(g.pass("step", "test.add", {{"a", "count@-1?start"}, {"b", "count@-1?"}},
               {{"target", "count"}}),
        "bias", 1);
  g.pass("show", "test.add", {{"a", "count"}}, {{"target", "result"}});
  const TestImage result = start(g, side, side);
  // Starts from 10 without history; each later frame doubles the previous frame and adds one.
  const float expected[] = {11, 23, 47, 11, 23};
  for (size_t i = 0; i < std::size(expected); ++i) {
    ASSERT_FALSE(frame(0.0f, {}, i == 3)); // The camera cuts.
    EXPECT_THAT(read(result), Each(FloatEq(expected[i]))) << "frame " << i;
  }
}

TEST_F(HistoryTest, TwoFramesBack_IsValidFromTheThirdFrame) {
  SmallGraph g{"export result"};
  g.history("count", 2);
  g.image("start");
  g.set(g.pass("begin", "test.fill", {}, {{"target", "start"}}), "value", 10);
  g.set(g.pass("step", "test.add", {{"a", "count@-2?start"}}, {{"target", "count"}}), "bias", 1);
  g.pass("show", "test.add", {{"a", "count"}}, {{"target", "result"}});
  const TestImage result = start(g, side, side);
  expect_frames(result, {11, 11, 12, 12, 13});
}

TEST_F(HistoryTest, AgeGrowsEachFrame_CutGivesItsReason) {
  const SmallGraph g = counter();
  const TestImage result = start(g, side, side);
  ASSERT_EQ(executor->history_count(), 1u);
  vulkan::HistoryState state = executor->history_state(0);
  EXPECT_EQ(state.resource, "count");
  EXPECT_FALSE(state.valid);
  EXPECT_EQ(state.reason, vulkan::HistoryReason::first_frame);
  for (uint32_t i = 1; i <= 3; ++i) {
    ASSERT_FALSE(frame());
    state = executor->history_state(0);
    EXPECT_TRUE(state.valid);
    EXPECT_EQ(state.age, i);
    EXPECT_EQ(state.reason, vulkan::HistoryReason::valid);
  }
  state = executor->history_state(0, true);
  EXPECT_FALSE(state.valid);
  EXPECT_EQ(state.reason, vulkan::HistoryReason::cut);
  EXPECT_TRUE(executor->history_state(0).valid) << "the query changes nothing";
  ASSERT_FALSE(frame(0.0f, {}, true));
  EXPECT_THAT(read(result), Each(FloatEq(1.0f))) << "a cut starts from zero";
  EXPECT_EQ(executor->history_state(0).age, 1u);
}

TEST_F(HistoryTest, OnCutKeep_SurvivesACut) {
  SmallGraph g = counter();
  for (ResourceDeclaration& resource : g.graph.resources)
    resource.history.on_cut = HistoryDeclaration::OnCut::keep;
  const TestImage result = start(g, side, side);
  run_frames(3);
  ASSERT_FALSE(frame(0.0f, {}, true));
  EXPECT_THAT(read(result), Each(FloatEq(4.0f)));
  EXPECT_EQ(executor->history_state(0).age, 4u);
}

// The same graph, or a graph of another size, replaces a running executor.
class ReplacedHistory : public HistoryTest {
protected:
  void take_over(const SmallGraph& graph, uint32_t width, uint32_t height) {
    replaced = std::move(executor);
    make_executor(graph, width, height);
  }
};

TEST_F(ReplacedHistory, SameGraph_KeepsCounting) {
  const SmallGraph g = counter(2);
  const TestImage result = start(g, side, side);
  run_frames(5);
  take_over(g, side, side);
  const vulkan::HistoryState state = executor->history_state(0, false, replaced.get());
  EXPECT_TRUE(state.valid);
  EXPECT_EQ(state.age, 5u);
  for (const float expected : {3, 4, 4}) {
    expect_frames(result, {expected});
    wait();
    replaced.reset(); // The executor is copied from only once.
  }
}

TEST_F(ReplacedHistory, SameGraph_KeepsBuffers) {
  // `light` counts one more in each tile that the previous frame listed.
  SmallGraph g{"in_out light"};
  g.buffer("classes", 0).history.frames = 1;
  g.buffer("tiles", 1);
  g.buffer("arguments", 3);
  g.pass("list", "test.list", {{"classes", "classes@-1"}},
         {{"tiles", "tiles"}, {"arguments", "arguments"}});
  g.pass("mark", "test.mark", {{"tiles", "tiles"}, {"arguments", "arguments"}},
         {{"target", "light"}});
  g.pass("classes", "test.classes", {}, {{"classes", "classes"}});
  const auto first_tiles_show = [&](const TestImage& light, float expected) {
    const std::vector<float> texels = read(light);
    for (uint32_t y = 0; y < side; ++y)
      for (uint32_t x = 0; x < side; ++x)
        ASSERT_EQ(texels[y * side + x], (y / 8 * (side / 8) + x / 8) % 3 == 0 ? expected : 0.0f)
            << x << ' ' << y;
  };
  make_executor(g, side, side);
  const TestImage light = bind(g, "light", std::vector<float>(size_t{side} * side, 0.0f));
  ASSERT_FALSE(frame());
  first_tiles_show(light, 0); // A new buffer is zero.
  ASSERT_FALSE(frame());
  first_tiles_show(light, 1);
  take_over(g, side, side);
  EXPECT_TRUE(executor->history_state(0, false, replaced.get()).valid);
  for (const float expected : {2.0f, 3.0f}) {
    ASSERT_FALSE(frame());
    first_tiles_show(light, expected);
    wait();
    replaced.reset();
  }
  for (const uint32_t width :
       {side, side - 1}) { // A width with the same number of tiles, then back.
    take_over(g, width == side ? side - 1 : side, side);
    EXPECT_FALSE(executor->history_state(0, false, replaced.get()).valid) << width;
    ASSERT_FALSE(frame());
    wait();
    replaced.reset();
  }
}

TEST_F(ReplacedHistory, OtherSize_KeepsOnlyRescaledHistories) {
  for (const bool rescale : {false, true}) {
    SmallGraph g = counter();
    for (ResourceDeclaration& resource : g.graph.resources)
      if (rescale) resource.history.on_resize = HistoryDeclaration::OnResize::rescale;
    start(g, side, side);
    run_frames(3);
    take_over(g, 2 * side + 5, side / 2);
    EXPECT_EQ(executor->previous_rectangle(replaced.get()).width, 2 * side + 5);
    EXPECT_EQ(executor->history_state(0, false, replaced.get()).valid, rescale);
    const TestImage result = bind(g, "result", {});
    expect_frames(result, {rescale ? 4.0f : 1.0f});
    wait();
    replaced.reset();
  }
}

// Other texels of the new size hold what lay outside of the rectangle, which no pass has written.
TEST_F(ReplacedHistory, OtherSize_KeepsTheTexelsThatTheRectangleFills) {
  SmallGraph g = counter();
  for (ResourceDeclaration& resource : g.graph.resources)
    resource.history.on_resize = HistoryDeclaration::OnResize::rescale;
  const uint32_t now = side * 3 / 4;
  for (uint32_t first = 0; first < side; ++first)
    for (const uint32_t length : {2u, 5u, side - first}) {
      if (first + length > side) continue;
      start(g, side, side);
      [[maybe_unused]] const TestImage result = bind(g, "result", {}); // keeps the image
      ASSERT_FALSE(frame(0.0f, {first, 0, length, 1}));
      take_over(g, now, side);
      uint32_t begin = now, end = 0; // as rescale_history.comp takes texels
      for (uint32_t x = 0; x < now; ++x)
        if (const uint32_t nearest = (2 * x + 1) * side / (2 * now);
            nearest >= first && nearest < first + length) {
          begin = std::min(begin, x);
          end = x + 1;
        }
      const vulkan::Rectangle carried = executor->previous_rectangle(replaced.get());
      EXPECT_EQ(carried.x, begin) << first << ' ' << length;
      EXPECT_EQ(carried.width, end - begin) << first << ' ' << length;
      wait();
      replaced.reset();
    }
}

// A previous rectangle without pixels would mean that there was no frame.
TEST_F(ReplacedHistory, OtherSize_KeepsAPixelOfTheRectangle) {
  SmallGraph g = counter();
  for (ResourceDeclaration& resource : g.graph.resources)
    resource.history.on_resize = HistoryDeclaration::OnResize::rescale;
  start(g, side, side);
  [[maybe_unused]] const TestImage result = bind(g, "result", {}); // keeps the image
  ASSERT_FALSE(frame(0.0f, {side - 1, 0, 1, 1}));
  take_over(g, side / 2, side / 2);
  const vulkan::Rectangle carried = executor->previous_rectangle(replaced.get());
  EXPECT_EQ(carried.x, side / 2 - 1);
  EXPECT_EQ(carried.width, 1u);
  EXPECT_EQ(carried.height, 1u);
  wait();
  replaced.reset();
}

TEST_F(ReplacedHistory, OtherSizeWithACut_StartsAnew) {
  SmallGraph g = counter();
  for (ResourceDeclaration& resource : g.graph.resources)
    resource.history.on_resize = HistoryDeclaration::OnResize::rescale;
  start(g, side, side);
  run_frames(3);
  take_over(g, 2 * side + 5, side / 2);
  EXPECT_FALSE(executor->history_state(0, true, replaced.get()).valid);
  const TestImage result = bind(g, "result", {});
  ASSERT_FALSE(frame(0.0f, {}, true));
  EXPECT_THAT(read(result), Each(FloatEq(1.0f)));
  wait();
  replaced.reset();
}

TEST_F(ReplacedHistory, OtherSize_TakesTheNearestTexel) {
  // Computes shown = kept@-1 and kept = source, a ramp.
  SmallGraph g{"import source", "export result", "history kept"};
  g.pass("show", "test.add", {{"a", "kept@-1"}}, {{"target", "result"}});
  g.pass("keep", "test.add", {{"a", "source"}}, {{"target", "kept"}});
  for (ResourceDeclaration& resource : g.graph.resources)
    if (resource.history.frames > 0)
      resource.history.on_resize = HistoryDeclaration::OnResize::rescale;
  make_executor(g, side, side);
  std::vector<float> ramp(size_t{side} * side);
  for (size_t i = 0; i < ramp.size(); ++i)
    ramp[i] = static_cast<float>(i);
  bind(g, "source", ramp);
  bind(g, "result", {});
  ASSERT_FALSE(frame());
  take_over(g, side / 2, 2 * side);
  bind(g, "source", std::vector<float>(size_t{side} * side, 0.0f));
  const TestImage result = bind(g, "result", {});
  ASSERT_FALSE(frame());
  const std::vector<float> shown = read(result);
  for (uint32_t y = 0; y < 2 * side; ++y)
    for (uint32_t x = 0; x < side / 2;
         // The centre of a texel of twice the width lies between two old texels; both are nearest.
         ++x)
      EXPECT_THAT(shown[y * (side / 2) + x],
                  ::testing::AnyOf(FloatEq(ramp[y / 2 * side + 2 * x]),
                                   FloatEq(ramp[y / 2 * side + 2 * x + 1])))
          << x << ", " << y;
}

TEST_F(ReplacedHistory, OtherPassType_StartsAnew) {
  SmallGraph filled{"export result", "history count"};
  filled.set(filled.pass("step", "test.fill", {}, {{"target", "count"}}), "value", 7);
  filled.pass("show", "test.add", {{"a", "count@-1"}}, {{"target", "result"}});
  start(filled, side, side);
  run_frames(3);
  const SmallGraph g = counter();
  take_over(g, side, side);
  const TestImage result = bind(g, "result", {});
  EXPECT_FALSE(executor->history_state(0, false, replaced.get()).valid);
  expect_frames(result, {1.0f});
}

class DiscardedFrame : public HistoryTest {
protected:
  void record_unsubmitted(bool reset_history = false) {
    vulkan::FrameInput lost;
    lost.command_buffer = begin_commands(); // Never submitted.
    lost.images = images;
    lost.frame_index = frame_index + 1;
    lost.reset_history = reset_history;
    ASSERT_FALSE(executor->record(lost));
  }
};

TEST_F(DiscardedFrame, LeavesNoEffect) {
  const SmallGraph g = counter(2);
  const TestImage result = start(g, side, side);
  const float expected[] = {1, 1, 2, 2, 3, 3};
  for (size_t i = 0; i < std::size(expected); ++i) {
    const vulkan::HistoryState before = executor->history_state(0);
    record_unsubmitted(i % 2 == 1); // Also tests a frame that resets all histories.
    ASSERT_TRUE(executor->discard_frame(frame_index + 1));
    const vulkan::HistoryState after = executor->history_state(0);
    EXPECT_EQ(after.age, i);
    EXPECT_EQ(after.valid, before.valid) << "frame " << i;
    EXPECT_EQ(after.reason, before.reason) << "frame " << i;
    EXPECT_EQ(after.lost, before.lost) << "frame " << i;
    ASSERT_FALSE(frame());
    EXPECT_THAT(read(result), Each(FloatEq(expected[i]))) << "frame " << i;
  }
}

TEST_F(DiscardedFrame, OnlyTheLastFrameOnce) {
  const SmallGraph g = counter();
  start(g, side, side);
  EXPECT_FALSE(executor->discard_frame(0));
  EXPECT_FALSE(executor->discard_frame(1));
  run_frames(2);
  wait();
  EXPECT_FALSE(executor->discard_frame(1));
  record_unsubmitted();
  EXPECT_TRUE(executor->discard_frame(3));
  EXPECT_FALSE(executor->discard_frame(3));
  EXPECT_FALSE(executor->discard_frame(2)) << "only the last frame can be discarded";
}

TEST_F(DiscardedFrame, LeavesNoCounters) {
  const SmallGraph g = counter();
  counters = true;
  start(g, side, side);
  run_frames(2);
  wait();
  uint32_t words[1];
  EXPECT_TRUE(executor->read_counters(1, words));
  record_unsubmitted(); // Frame 3 uses the slot of frame 1.
  ASSERT_TRUE(executor->discard_frame(3));
  EXPECT_FALSE(executor->read_counters(3, words));
  EXPECT_FALSE(executor->read_counters(1, words)) << "frame 3 cleared them";
  EXPECT_TRUE(executor->read_counters(2, words));
}

} // namespace
} // namespace dermis::testing
