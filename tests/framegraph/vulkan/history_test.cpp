// Laws of histories: what a frame wrote is what the next reads, across submissions, and age and validity tell
// so.
#include "tests/framegraph/vulkan/executor_fixture.hpp"

#include <gmock/gmock.h>

namespace dermis::testing {
namespace {

using ::testing::Each;
using ::testing::FloatEq;

constexpr uint32_t side = 16;

// count = count@-1 + 1, shown in result.
SmallGraph counter(uint32_t frames = 1) {
  SmallGraph g;
  g.exported("result");
  g.history("count", frames);
  g.set(g.pass("step", "test.add", {{"a", "count@-" + std::to_string(frames)}}, {{"target", "count"}}),
        "bias", 1);
  g.pass("show", "test.add", {{"a", "count"}}, {{"target", "result"}});
  return g;
}

class HistoryTest : public ExecutorTest {};

TEST_F(HistoryTest, ANewHistoryIsZeroAndEachFrameSeesTheOneBefore) {
  const SmallGraph g = counter();
  make_executor(g, side, side);
  const TestImage result = bind(g, "result", {});
  for (int i = 1; i <= 5; ++i)
    ASSERT_FALSE(frame());
  EXPECT_THAT(read(result), Each(FloatEq(5.0f)));
}

TEST_F(HistoryTest, TwoFramesBackIsTwoFramesBack) {
  const SmallGraph g = counter(2); // two interleaved counters
  make_executor(g, side, side);
  const TestImage result = bind(g, "result", {});
  const float expected[] = {1, 1, 2, 2, 3, 3, 4};
  for (const float value : expected) {
    ASSERT_FALSE(frame());
    EXPECT_THAT(read(result), Each(FloatEq(value)));
  }
}

TEST_F(HistoryTest, RenewedInPlaceKeepsCountingAndStartsAnewAfterACut) {
  SmallGraph g;
  g.exported("result");
  g.history("count");
  g.image("copy");
  g.pass("look", "test.add", {{"a", "count@-1"}}, {{"target", "copy"}});
  g.set(g.pass("step", "test.add", {{"a", "copy"}}, {{"target", "count"}}), "bias", 1);
  g.pass("show", "test.add", {{"a", "count"}}, {{"target", "result"}});
  make_executor(g, side, side);
  const TestImage result = bind(g, "result", {});
  for (int i = 1; i <= 4; ++i)
    ASSERT_FALSE(frame());
  EXPECT_THAT(read(result), Each(FloatEq(4.0f)));
  ASSERT_FALSE(frame(0.0f, {}, true));
  EXPECT_THAT(read(result), Each(FloatEq(1.0f)));
}

TEST_F(HistoryTest, WhereAHistoryIsNotValidItsPortReadsWhatTheGraphSays) {
  SmallGraph g;
  g.exported("result");
  g.history("count");
  g.image("start");
  g.set(g.pass("begin", "test.fill", {}, {{"target", "start"}}), "value", 10);
  g.set(g.pass("step", "test.add", {{"a", "count@-1?start"}, {"b", "count@-1?"}}, {{"target", "count"}}),
        "bias", 1);
  g.pass("show", "test.add", {{"a", "count"}}, {{"target", "result"}});
  make_executor(g, side, side);
  const TestImage result = bind(g, "result", {});
  // From 10 and nothing, then twice the frame before, and one more each time.
  const float expected[] = {11, 23, 47, 11, 23};
  for (size_t i = 0; i < std::size(expected); ++i) {
    ASSERT_FALSE(frame(0.0f, {}, i == 3)); // the camera cuts
    EXPECT_THAT(read(result), Each(FloatEq(expected[i]))) << "frame " << i;
  }
}

TEST_F(HistoryTest, TwoFramesBackIsValidFromTheThirdFrameOn) {
  SmallGraph g;
  g.exported("result");
  g.history("count", 2);
  g.image("start");
  g.set(g.pass("begin", "test.fill", {}, {{"target", "start"}}), "value", 10);
  g.set(g.pass("step", "test.add", {{"a", "count@-2?start"}}, {{"target", "count"}}), "bias", 1);
  g.pass("show", "test.add", {{"a", "count"}}, {{"target", "result"}});
  make_executor(g, side, side);
  const TestImage result = bind(g, "result", {});
  for (const float expected : {11, 11, 12, 12, 13}) {
    ASSERT_FALSE(frame());
    EXPECT_THAT(read(result), Each(FloatEq(expected)));
  }
}

TEST_F(HistoryTest, AgeGrowsWithEveryFrameAndACutSaysWhy) {
  const SmallGraph g = counter();
  make_executor(g, side, side);
  const TestImage result = bind(g, "result", {});
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
  EXPECT_TRUE(executor->history_state(0).valid) << "asking changes nothing";
  ASSERT_FALSE(frame(0.0f, {}, true));
  EXPECT_THAT(read(result), Each(FloatEq(1.0f))) << "a cut starts from zero";
  EXPECT_EQ(executor->history_state(0).age, 1u);
}

TEST_F(HistoryTest, AHistoryThatKeepsSurvivesACut) {
  SmallGraph g = counter();
  for (ResourceDeclaration& resource : g.graph.resources)
    resource.history.on_cut = HistoryDeclaration::OnCut::keep;
  make_executor(g, side, side);
  const TestImage result = bind(g, "result", {});
  for (int i = 1; i <= 3; ++i)
    ASSERT_FALSE(frame());
  ASSERT_FALSE(frame(0.0f, {}, true));
  EXPECT_THAT(read(result), Each(FloatEq(4.0f)));
  EXPECT_EQ(executor->history_state(0).age, 4u);
}

TEST_F(HistoryTest, AFrameThatWasNeverSubmittedIsForgotten) {
  const SmallGraph g = counter();
  make_executor(g, side, side);
  const TestImage result = bind(g, "result", {});
  vulkan::FrameInput lost;
  lost.command_buffer = begin_commands(); // never submitted
  lost.images = images;
  lost.frame_index = ++frame_index;
  ASSERT_FALSE(executor->record(lost));
  executor->discard_frames();
  EXPECT_EQ(executor->history_state(0).reason, vulkan::HistoryReason::discarded);
  for (int i = 1; i <= 3; ++i)
    ASSERT_FALSE(frame());
  EXPECT_THAT(read(result), Each(FloatEq(3.0f)));
}

} // namespace
} // namespace dermis::testing
