// Tests that the host's images contain the results of all passes after a frame.
#include "tests/framegraph/vulkan/executor_fixture.hpp"

namespace dermis::testing {
namespace {

constexpr uint32_t width = 21, height = 13; // Not multiples of the tile side.

// Values below are small integers and quarters, exact in r32f, so the tests compare for equality.

TEST_F(ExecutorTest, NextPassReadsTheWrite) {
  SmallGraph g{"export result", "image first"};
  g.set(g.pass("fill", "test.fill", {}, {{"target", "first"}}), "slope", 2);
  g.set(g.pass("add", "test.add", {{"a", "first"}}, {{"target", "result"}}), "bias", 0.25);
  const TestImage result = start(g, width, height);
  ASSERT_FALSE(frame(10.0f));
  const std::vector<float> texels = read(result);
  for (uint32_t y = 0; y < height; ++y)
    for (uint32_t x = 0; x < width; ++x)
      ASSERT_EQ(texels[y * width + x], 1.0f + 2.0f * static_cast<float>(x) + 10.0f + 0.25f)
          << x << ' ' << y;
}

TEST_F(ExecutorTest, TransientsThatShareMemoryDoNotDisturbEachOther) {
  SmallGraph g{"export result"};
  for (const char* name : {"a", "b", "c", "d"})
    g.image(name);
  g.set(g.pass("fill", "test.fill", {}, {{"target", "a"}}), "value", 5);
  const char* chain[] = {"a", "b", "c", "d", "result"};
  for (int i = 0; i < 4; ++i)
    g.set(g.pass(std::string("add") + chain[i], "test.add", {{"a", chain[i]}},
                 {{"target", chain[i + 1]}}),
          "bias", 1);
  make_executor(g, width, height);
  uint32_t sharing = 0;
  const Plan& plan = executor->plan();
  for (size_t i = 0; i < plan.placements.size(); ++i)
    for (size_t k = 0; k < i; ++k)
      sharing += plan.placements[i].heap == plan.placements[k].heap &&
                 plan.placements[i].offset < plan.placements[k].offset + plan.placements[k].size &&
                 plan.placements[k].offset < plan.placements[i].offset + plan.placements[i].size;
  EXPECT_GT(sharing, 0u) << "the plan shares no memory, so this test proves nothing";
  const TestImage result = bind(g, "result", {});
  run_frames(4);
  EXPECT_THAT(read(result), Each(FloatEq(9.0f)));
}

TEST_F(ExecutorTest, AnImportIsUpdatedInPlace) {
  SmallGraph g{"in_out light", "image copy"};
  g.set(g.pass("add", "test.add", {{"a", "light"}}, {{"target", "copy"}}), "bias", 3);
  g.pass("back", "test.add", {{"a", "copy"}}, {{"target", "light"}});
  make_executor(g, width, height);
  const TestImage light = bind(g, "light", std::vector<float>(width * height, 4.0f));
  expect_frames(light, {7.0, 10.0});
}

TEST_F(ExecutorTest, ImagesAreReleasedInTheRequestedState) {
  SmallGraph g{"import light"};
  g.import("depth", Format::d32f);
  g.exported("result");
  g.pass("add", "test.add", {{"a", "light"}, {"b", "depth"}}, {{"target", "result"}});
  make_executor(g, width, height);
  const TestImage light = bind(g, "light", std::vector<float>(width * height, 4.0f));
  const TestImage depth =
      make_image(VK_FORMAT_D32_SFLOAT, width, height,
                 VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT);
  constexpr VkImageLayout odd[] = {VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                   VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                                   VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_GENERAL};
  upload(depth, bytes_of(std::vector<float>(width * height, 0.5f)),
         VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL);
  const TestImage result = bind(g, "result", {});
  VkImageLayout light_layout = VK_IMAGE_LAYOUT_GENERAL, result_layout = VK_IMAGE_LAYOUT_GENERAL;
  for (const VkImageLayout layout : odd) {
    bind_image(g, "light", light, light_layout, layout);
    bind_image(g, "result", result, result_layout, layout);
    bind_image(g, "depth", depth, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL,
               VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL);
    ASSERT_FALSE(frame());
    light_layout = result_layout = layout;
    EXPECT_THAT(read(result, layout), Each(FloatEq(4.5f)));
  }
}

TEST_F(ExecutorTest, AnUnboundOptionalPortReadsZeroAndItsMaskBitIsClear) {
  SmallGraph g{"import light"};
  g.import("more", Format::r32f, true);
  g.import("ids", Format::r32_uint, true);
  g.exported("result");
  g.pass("add", "test.add", {{"a", "light"}, {"b", "more"}, {"ids", "ids"}},
         {{"target", "result"}});
  make_executor(g, width, height, {"more", "ids"});
  bind(g, "light", std::vector<float>(width * height, 4.0f));
  const TestImage result = bind(g, "result", {});
  ASSERT_FALSE(frame());
  // A placeholder other than zero would add -1000 times its value.
  EXPECT_THAT(read(result), Each(FloatEq(4.0f)));
}

TEST_F(ExecutorTest, ABoundOptionalPortIsRead) {
  SmallGraph g{"import light"};
  g.import("ids", Format::r8_uint, true);
  g.exported("result");
  g.exported("second", Format::rgba16f);
  g.pass("add", "test.add", {{"a", "light"}, {"ids", "ids"}},
         {{"target", "result"}, {"second", "second"}});
  make_executor(g, width, height);
  bind(g, "light", std::vector<float>(width * height, 4.0f));
  const TestImage ids = make_image(VK_FORMAT_R8_UINT, width, height, VK_IMAGE_USAGE_SAMPLED_BIT);
  upload(ids, bytes_of(std::vector<uint8_t>(width * height, 7)), VK_IMAGE_LAYOUT_GENERAL);
  bind_image(g, "ids", ids, VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_LAYOUT_GENERAL);
  const TestImage second =
      make_image(VK_FORMAT_R16G16B16A16_SFLOAT, width, height, VK_IMAGE_USAGE_STORAGE_BIT);
  transition(second, VK_IMAGE_LAYOUT_GENERAL);
  bind_image(g, "second", second, VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_LAYOUT_GENERAL);
  const TestImage result = bind(g, "result", {});
  expect_frames(result, {11.0f});
  constexpr uint16_t minus_eleven = 0xc980; // fp16: -1.375 * 2^3.
  EXPECT_THAT(values_of<uint16_t>(download(second, VK_IMAGE_LAYOUT_GENERAL)), Each(minus_eleven));
}

TEST_F(ExecutorTest, OnlyTheRenderRectangleIsWritten) {
  SmallGraph g{"in_out light"};
  g.set(g.pass("fill", "test.fill", {}, {{"target", "light"}}), "value", 2);
  make_executor(g, width, height);
  const TestImage light = bind(g, "light", std::vector<float>(width * height, -1.0f));
  const vulkan::Rectangle inside{3, 2, 10, 9};
  ASSERT_FALSE(frame(0.0f, inside));
  const std::vector<float> texels = read(light);
  for (uint32_t y = 0; y < height; ++y)
    for (uint32_t x = 0; x < width; ++x) {
      const bool in = x >= 3 && x < 13 && y >= 2 && y < 11;
      ASSERT_EQ(texels[y * width + x], in ? 2.0f : -1.0f) << x << ' ' << y;
    }
  EXPECT_EQ(executor->previous_rectangle().width, 10u);
}

TEST_F(ExecutorTest, AnIndirectDispatchRunsOverTheListedTiles) {
  SmallGraph g{"in_out light"};
  g.buffer("classes", 0);
  g.buffer("tiles", 1);
  g.buffer("arguments", 3);
  g.pass("classes", "test.classes", {}, {{"classes", "classes"}});
  g.pass("list", "test.list", {{"classes", "classes"}},
         {{"tiles", "tiles"}, {"arguments", "arguments"}});
  g.pass("mark", "test.mark", {{"tiles", "tiles"}, {"arguments", "arguments"}},
         {{"target", "light"}});
  make_executor(g, 200, 72); // 25 x 9 tiles: four groups over the tile grid.
  const TestImage light = bind(g, "light", std::vector<float>(200 * 72, 0.0f));
  run_frames(2);
  const std::vector<float> texels = read(light);
  for (uint32_t y = 0; y < 72; ++y)
    for (uint32_t x = 0; x < 200; ++x)
      ASSERT_EQ(texels[y * 200 + x], (y / 8 * 25 + x / 8) % 3 == 0 ? 2.0f : 0.0f) << x << ' ' << y;
}

TEST_F(ExecutorTest, IndirectArgumentsOfTheHost_AreReadAtTheirOffset) {
  SmallGraph g{"in_out light"};
  for (const char* name : {"tiles", "arguments"})
    g.buffer(name, 1).origin = Origin::imported;
  g.pass("mark", "test.mark", {{"tiles", "tiles"}, {"arguments", "arguments"}},
         {{"target", "light"}});
  make_executor(g, 32, 16); // 8 tiles
  const TestImage light = bind(g, "light", std::vector<float>(32 * 16, 0.0f));
  const VkDeviceSize alignment = dermis_device.properties.limits.minStorageBufferOffsetAlignment;
  const auto skipped = static_cast<size_t>(std::max<VkDeviceSize>(alignment / 4, 4));
  const auto give = [&](const char* name, const std::vector<uint32_t>& words,
                        VkBufferUsageFlags usage) {
    std::vector<uint32_t> all(skipped, 0);
    all.insert(all.end(), words.begin(), words.end());
    all.resize(skipped + 16);
    const auto slot = static_cast<size_t>(g.slot(name));
    buffers.resize(std::max(buffers.size(), slot + 1));
    buffers[slot] = {make_buffer(bytes_of(all), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | usage),
                     4 * skipped,
                     4 * 16,
                     {},
                     {}};
  };
  give("tiles", {1, 2 | 1 << 16}, 0);
  give("arguments", {2, 1, 1}, VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT);
  ASSERT_FALSE(frame());
  const std::vector<float> texels = read(light);
  for (uint32_t y = 0; y < 16; ++y)
    for (uint32_t x = 0; x < 32; ++x)
      ASSERT_EQ(texels[y * 32 + x], (x / 8 == 1 && y < 8) || (x / 8 == 2 && y >= 8) ? 1.0f : 0.0f)
          << x << ' ' << y;
}

TEST_F(ExecutorTest, MoreDescriptorsThanADeviceAllows_AreUnsupported) {
  SmallGraph g{"export result"};
  g.pass("fill", "test.fill", {}, {{"target", "result"}});
  const Plan plan = g.compile(profile, 16, 16);
  dermis_device.properties.limits.maxPerStageDescriptorStorageImages = 0;
  std::unique_ptr<vulkan::Executor> none;
  const vulkan::Error error = try_executor(g, plan, dermis_device, none);
  EXPECT_EQ(error.kind, vulkan::ErrorKind::unsupported);
  EXPECT_THAT(error.text, HasAll("'test.fill' binds 1 storage images", "allows 0 per stage"));
}

TEST_F(ExecutorTest, AClearZeroesImagesAndBuffers) {
  SmallGraph g{"export result", "import light"};
  g.buffer("weights", 1);
  g.pass("clear", "test.clear", {}, {{"target", "light"}, {"buffer", "weights"}});
  g.set(g.pass("add", "test.add", {{"a", "light"}, {"weights", "weights"}}, {{"target", "result"}}),
        "bias", 1);
  make_executor(g, width, height);
  bind(g, "light", std::vector<float>(width * height, 8.0f));
  const TestImage result = bind(g, "result", {});
  expect_frames(result, {1.0f});
}

TEST_F(ExecutorTest, TheEnvironmentGivesTablesAndALinearSampler) {
  SmallGraph g{"export result", "image ramp"};
  g.set(g.pass("fill", "test.fill", {}, {{"target", "ramp"}}), "slope", 4);
  g.pass("sample", "test.sample", {{"a", "ramp"}}, {{"target", "result"}});
  const TestImage result = start(g, width, height);
  ASSERT_FALSE(frame());
  // Sampling a quarter of the way to the next texel, times table[1] = 2. Filter weights have at
  // least 4 fraction bits (subTexelPrecisionBits >= 4), so a quarter is exact.
  const std::vector<float> texels = read(result);
  EXPECT_FLOAT_EQ(texels[5], 2.0f * (1.0f + 4.0f * 5.25f));
  EXPECT_FLOAT_EQ(texels[width - 1], 2.0f * (1.0f + 4.0f * 20.0f)); // Clamped to the edge.
}

TEST_F(ExecutorTest, CountersAreZeroAtTheStartOfAFrame) {
  counters = true;
  SmallGraph g{"export first", "export second", "export third"};
  for (const char* name : {"first", "second", "third"})
    g.pass(name, "test.count", {}, {{"target", name}});
  make_executor(g, width, height);
  bind(g, "first", {});
  bind(g, "second", {});
  const TestImage third = bind(g, "third", {});
  uint32_t words[1];
  for (uint64_t index = 1; index <= 3; ++index) {
    ASSERT_FALSE(frame());
    wait();
    ASSERT_TRUE(executor->read_counters(index, words));
    EXPECT_EQ(words[0], 7u) << "frame " << index;
  }
  EXPECT_EQ(read(third).front(), 7.0f);
}

TEST_F(ExecutorTest, ASettingOfTheHostIsEffectiveInTheNextFrame) {
  SmallGraph g;
  g.setting("strength", 3.0);
  g.exported("result");
  g.follow(g.pass("fill", "test.fill", {}, {{"target", "result"}}), "value", "strength");
  const TestImage result = start(g, width, height);
  expect_frames(result, {3.0f});
  settings = {{SettingType::real, 0, 6.5}};
  expect_frames(result, {6.5f});
}

TEST_F(ExecutorTest, EveryPassHasATimeOfACompletedFrame) {
  if (!dermis_device.timings) GTEST_SKIP() << "the queue family writes no timestamps";
  SmallGraph g{"export result", "image first"};
  g.pass("fill", "test.fill", {}, {{"target", "first"}});
  g.pass("add", "test.add", {{"a", "first"}}, {{"target", "result"}});
  start(g, 256, 256);
  std::vector<vulkan::PassTiming> timings(2);
  uint64_t timed = 0;
  EXPECT_FALSE(executor->read_timings(0, timed, timings)) << "nothing was recorded yet";
  run_frames(3);
  wait();
  ASSERT_TRUE(executor->read_timings(2, timed, timings));
  EXPECT_EQ(timed, 2u) << "frame 3 is not reported as complete";
  ASSERT_TRUE(executor->read_timings(3, timed, timings));
  EXPECT_EQ(timed, 3u);
  EXPECT_EQ(timings[0].pass, "fill");
  EXPECT_EQ(timings[1].pass, "add");
  constexpr uint64_t ten_seconds = 10'000'000'000;
  for (const auto& timing : timings) {
    EXPECT_GT(timing.nanoseconds, 0u) << timing.pass;
    EXPECT_LT(timing.nanoseconds, ten_seconds) << timing.pass;
  }
}

} // namespace
} // namespace dermis::testing
