// Tests subresource ranges on a device under validation: each port reads the mips and layers that
// it names.
#include "tests/framegraph/vulkan/executor_fixture.hpp"

namespace dermis::testing {
namespace {

constexpr uint32_t whole = 16, half = 8;

class PartsTest : public ExecutorTest {};

// Builds two layers of two mips, each filled with a different number. The frame has the size of mip
// 1, half the texels.
SmallGraph filled() {
  SmallGraph g{"export result"};
  ResourceDeclaration& image = g.image("image");
  image.mips = image.layers = 2;
  const std::pair<const char*, double> parts[] = {
      {"image#0[0]", 1}, {"image#0[1]", 10}, {"image#1[0]", 100}, {"image#1[1]", 1000}};
  for (const auto& [part, value] : parts)
    g.set(g.pass(std::string("fill ") + part, "test.fill", {}, {{"target", part}}), "value", value);
  return g;
}

TEST_F(PartsTest, PortReadsTheNamedMipAndLayer) {
  const std::pair<std::pair<const char*, const char*>, float> cases[] = {
      {{"image#0[0]", "image#0[1]"}, 11.0f},
      {{"image#1[0]", "image#1[1]"}, 1100.0f},
      {{"image#0[1]", "image#1[0]"}, 110.0f}};
  for (const auto& [ports, sum] : cases) {
    SmallGraph g = filled();
    g.pass("add", "test.add", {{"a", ports.first}, {"b", ports.second}}, {{"target", "result"}});
    const TestImage result = start(g, whole, whole);
    for (int i = 0; i < 3; ++i)
      ASSERT_FALSE(frame(0.0f, {0, 0, half, half}));
    const std::vector<float> texels = read(result);
    for (uint32_t y = 0; y < half; ++y)
      for (uint32_t x = 0; x < half; ++x)
        ASSERT_EQ(texels[y * whole + x], sum) << ports.first << " + " << ports.second;
    executor.reset();
  }
}

TEST_F(PartsTest, ClearingAPartLeavesTheOthers) {
  SmallGraph g = filled();
  g.pass("clear", "test.clear", {}, {{"target", "image#0[0]"}});
  // The clear overwrites that part, so its fill would be culled; the test removes the fill pass.
  g.graph.passes.erase(g.graph.passes.begin());
  g.pass("add", "test.add", {{"a", "image#0[0]"}, {"b", "image#0[1]"}}, {{"target", "result"}});
  const TestImage result = start(g, whole, whole);
  ASSERT_FALSE(frame(0.0f, {0, 0, half, half}));
  EXPECT_EQ(read(result)[0], 10.0f);
}

// Mip 0 counts frames; mip 1 sums mip 0 of all frames.
SmallGraph two_histories_in_one() {
  SmallGraph g{"export result"};
  g.history("kept", 1).mips = 2;
  g.set(g.pass("count", "test.add", {{"a", "kept#0@-1"}}, {{"target", "kept#0"}}), "bias", 1);
  g.pass("sum", "test.add", {{"a", "kept#1@-1"}, {"b", "kept#0"}}, {{"target", "kept#1"}});
  return g;
}

TEST_F(PartsTest, HistoryMipsComeFromTheRequestedFrame) {
  SmallGraph g = two_histories_in_one();
  g.pass("show", "test.add", {{"a", "kept#1"}, {"b", "kept#0@-1"}}, {{"target", "result"}});
  const TestImage result = start(g, whole, whole);
  for (const float expected : {1.0f + 0, 3.0f + 1, 6.0f + 2, 10.0f + 3, 15.0f + 4}) {
    ASSERT_FALSE(frame(0.0f, {0, 0, half, half}));
    EXPECT_EQ(read(result)[0], expected);
  }
}

// No pass accesses mip 1 of the history, which has no layout then.
TEST_F(PartsTest, HistoryMipsWithoutAccess_AreLeftAlone) {
  SmallGraph g{"export result"};
  g.history("kept", 1).mips = 2;
  g.set(g.pass("count", "test.add", {{"a", "kept#0@-1"}}, {{"target", "kept#0"}}), "bias", 1);
  g.pass("show", "test.add", {{"a", "kept#0"}}, {{"target", "result"}});
  const TestImage result = start(g, whole, whole);
  for (const float expected : {1.0f, 2.0f, 3.0f}) {
    ASSERT_FALSE(frame());
    EXPECT_EQ(read(result)[0], expected);
  }
}

// Nothing reads mip 1 of this frame, so it keeps the layout of its write; mip 0 keeps the layout of
// its read.
TEST_F(PartsTest, HistoryMipsKeepSeparateLayouts) {
  SmallGraph g = two_histories_in_one();
  g.pass("show", "test.add", {{"a", "kept#1@-1"}}, {{"target", "result"}});
  const TestImage result = start(g, whole, whole);
  for (const float expected : {0.0f, 1.0f, 3.0f, 6.0f, 10.0f}) {
    ASSERT_FALSE(frame(0.0f, {0, 0, half, half}));
    EXPECT_EQ(read(result)[0], expected);
  }
}

} // namespace
} // namespace dermis::testing
