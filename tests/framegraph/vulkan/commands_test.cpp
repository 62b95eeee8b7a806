// Tests the recorded commands through a function table that records calls.
#include "tests/framegraph/vulkan/executor_fixture.hpp"

namespace dermis::testing {
namespace {

constexpr size_t max_barriers = 64;

struct Recorded { // Static: Vulkan functions have no user pointer.
  VkImageMemoryBarrier2 barriers[max_barriers];
  size_t barrier_count = 0, batches = 0, dispatches = 0, labels = 0;
  uint32_t groups[3];
  VkMemoryBarrier2 all_memory; // The last barrier that names no resource.
  size_t all_memory_count = 0, dispatches_before_it = 0;
};
Recorded recorded;

void make_recording(vulkan::FunctionTable& table) {
  table.vkCmdPipelineBarrier2 = [](VkCommandBuffer, const VkDependencyInfo* info) {
    if (info->memoryBarrierCount == 1 &&
        info->pMemoryBarriers->srcStageMask == VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT)
      return; // of the tables, which some devices copy in the first frame
    ++recorded.batches;
    for (uint32_t i = 0; i < info->memoryBarrierCount; ++i) {
      recorded.all_memory = info->pMemoryBarriers[i];
      recorded.dispatches_before_it = recorded.dispatches;
      ++recorded.all_memory_count;
    }
    for (uint32_t i = 0; i < info->imageMemoryBarrierCount && recorded.barrier_count < max_barriers;
         ++i)
      recorded.barriers[recorded.barrier_count++] = info->pImageMemoryBarriers[i];
  };
  table.vkCmdBindPipeline = [](VkCommandBuffer, VkPipelineBindPoint, VkPipeline) {};
  table.vkCmdBindDescriptorSets = [](VkCommandBuffer, VkPipelineBindPoint, VkPipelineLayout,
                                     uint32_t, uint32_t, const VkDescriptorSet*, uint32_t,
                                     const uint32_t*) {};
  table.vkCmdPushConstants = [](VkCommandBuffer, VkPipelineLayout, VkShaderStageFlags, uint32_t,
                                uint32_t, const void*) {};
  table.vkCmdDispatch = [](VkCommandBuffer, uint32_t x, uint32_t y, uint32_t z) {
    ++recorded.dispatches;
    recorded.groups[0] = x;
    recorded.groups[1] = y;
    recorded.groups[2] = z;
  };
  table.vkCmdClearColorImage = [](VkCommandBuffer, VkImage, VkImageLayout, const VkClearColorValue*,
                                  uint32_t, const VkImageSubresourceRange*) {};
  table.vkCmdFillBuffer = [](VkCommandBuffer, VkBuffer, VkDeviceSize, VkDeviceSize, uint32_t) {};
  table.vkCmdCopyBuffer = [](VkCommandBuffer, VkBuffer, VkBuffer, uint32_t, const VkBufferCopy*) {};
  table.vkCmdResetQueryPool = [](VkCommandBuffer, VkQueryPool, uint32_t, uint32_t) {};
  table.vkCmdWriteTimestamp2 = [](VkCommandBuffer, VkPipelineStageFlags2, VkQueryPool, uint32_t) {};
  table.vkCmdBeginDebugUtilsLabelEXT = [](VkCommandBuffer, const VkDebugUtilsLabelEXT*) {
    ++recorded.labels;
  };
  table.vkCmdEndDebugUtilsLabelEXT = [](VkCommandBuffer) {};
  table.vkUpdateDescriptorSets = [](VkDevice, uint32_t, const VkWriteDescriptorSet*, uint32_t,
                                    const VkCopyDescriptorSet*) {};
}

class CommandsTest : public ExecutorTest {
protected:
  void SetUp() override {
    ExecutorTest::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    make_recording(dermis_device.vk);
    recorded = {};
  }
  vulkan::RecordResult record(vulkan::Rectangle rectangle = {}, bool memory_overwritten = false) {
    vulkan::FrameInput input;
    input.command_buffer = reinterpret_cast<VkCommandBuffer>(this); // Never dereferenced.
    input.images = images;
    input.rectangle = rectangle;
    input.memory_overwritten = memory_overwritten;
    input.frame_index = ++frame_index;
    return executor->record(input);
  }
  SmallGraph update() const {
    SmallGraph g{"in_out light", "image copy"};
    g.pass("add", "test.add", {{"a", "light"}}, {{"target", "copy"}});
    g.pass("back", "test.add", {{"a", "copy"}}, {{"target", "light"}});
    return g;
  }
};

TEST_F(CommandsTest, OtherQueueFamily_IsAcquiredAndReleased) {
  const SmallGraph g = update();
  make_executor(g, 16, 16);
  const uint32_t other = queue_family + 1;
  bind(g, "light", {});
  images[0].before = {VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, other, 0, 0};
  images[0].after = {VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, other, 0, 0};
  ASSERT_FALSE(record());
  ASSERT_GT(recorded.barrier_count, 2u);
  const VkImageMemoryBarrier2& acquire = recorded.barriers[0];
  EXPECT_EQ(acquire.image, images[0].image);
  EXPECT_EQ(acquire.srcQueueFamilyIndex, other);
  EXPECT_EQ(acquire.dstQueueFamilyIndex, queue_family);
  EXPECT_EQ(acquire.oldLayout, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
  EXPECT_EQ(acquire.newLayout, acquire.oldLayout) << "the host's release names the same pair";
  const VkImageMemoryBarrier2& release = recorded.barriers[recorded.barrier_count - 1];
  EXPECT_EQ(release.srcQueueFamilyIndex, queue_family);
  EXPECT_EQ(release.dstQueueFamilyIndex, other);
  EXPECT_EQ(release.oldLayout, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
  EXPECT_EQ(release.newLayout, release.oldLayout);
  for (size_t i = 1; i + 1 < recorded.barrier_count; ++i)
    EXPECT_EQ(recorded.barriers[i].srcQueueFamilyIndex, VK_QUEUE_FAMILY_IGNORED) << i;
}

TEST_F(CommandsTest, OwnQueueFamily_NeedsNoTransfer) {
  const SmallGraph g = update();
  make_executor(g, 16, 16);
  bind(g, "light", {});
  images[0].before.queue_family = images[0].after.queue_family = queue_family;
  ASSERT_FALSE(record());
  for (size_t i = 0; i < recorded.barrier_count; ++i)
    EXPECT_EQ(recorded.barriers[i].srcQueueFamilyIndex, VK_QUEUE_FAMILY_IGNORED) << i;
}

TEST_F(CommandsTest, NoBarrier_WithoutHostWorkAndLayoutChange) {
  SmallGraph g{"import light", "export result"};
  g.pass("add", "test.add", {{"a", "light"}}, {{"target", "result"}});
  make_executor(g, 16, 16);
  bind(g, "light", {});
  bind(g, "result", {});
  const size_t light = static_cast<size_t>(g.slot("light"));
  images[light].before = {VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, VK_QUEUE_FAMILY_IGNORED, 0, 0};
  ASSERT_FALSE(record());
  size_t before_dispatch = 0;
  for (size_t i = 0; i < recorded.barrier_count; ++i)
    before_dispatch += recorded.barriers[i].image == images[light].image &&
                       recorded.barriers[i].oldLayout == recorded.barriers[i].newLayout;
  EXPECT_EQ(before_dispatch, 0u);
}

TEST_F(CommandsTest, FirstFrameAfterAnotherPlan_WaitsForItsWrites) {
  const SmallGraph g = update();
  make_executor(g, 16, 16);
  bind(g, "light", {});
  ASSERT_FALSE(record());
  EXPECT_EQ(recorded.all_memory_count, 0u);
  recorded = {};
  ASSERT_FALSE(record({}, true));
  ASSERT_EQ(recorded.all_memory_count, 1u);
  EXPECT_EQ(recorded.dispatches_before_it, 0u);
  EXPECT_EQ(recorded.all_memory.srcStageMask, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT);
  EXPECT_EQ(recorded.all_memory.dstStageMask, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT);
  EXPECT_EQ(recorded.all_memory.srcAccessMask, VK_ACCESS_2_MEMORY_WRITE_BIT);
  EXPECT_EQ(recorded.all_memory.dstAccessMask,
            VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT);
}

TEST_F(CommandsTest, AliasedMemory_UsesAGlobalBarrier) {
  SmallGraph g{"in_out light"};
  for (const char* name : {"one", "two", "three"}) // The third image uses the memory of the first.
    g.image(name);
  g.pass("a", "test.add", {{"a", "light"}}, {{"target", "one"}});
  g.pass("b", "test.add", {{"a", "one"}}, {{"target", "two"}});
  g.pass("c", "test.add", {{"a", "two"}}, {{"target", "three"}});
  g.pass("d", "test.add", {{"a", "three"}}, {{"target", "light"}});
  make_executor(g, 16, 16);
  bind(g, "light", {});
  ASSERT_FALSE(record());
  // 'one' waits for 'three' of the previous frame, and 'three' waits for 'one'; 'two' has separate
  // memory.
  EXPECT_EQ(recorded.all_memory_count, 2u);
  EXPECT_EQ(recorded.dispatches_before_it, 2u);
  EXPECT_EQ(recorded.all_memory.srcStageMask, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT);
  EXPECT_EQ(recorded.all_memory.srcAccessMask, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT);
  EXPECT_EQ(recorded.all_memory.dstStageMask, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT);
  EXPECT_EQ(recorded.all_memory.dstAccessMask, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT);
  // The validation layer needs image barriers that name the writes, even though 'one' was read.
  size_t memory_overwritten = 0;
  for (size_t i = 0; i < recorded.barrier_count; ++i)
    memory_overwritten +=
        recorded.barriers[i].oldLayout == VK_IMAGE_LAYOUT_UNDEFINED &&
        recorded.barriers[i].srcAccessMask == VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;
  EXPECT_EQ(memory_overwritten, 2u);
}

TEST_F(CommandsTest, ClearsOfAFrameShareTwoBarrierCalls) {
  SmallGraph g{"export result", "history first", "history second"};
  for (const std::string name : {"first", "second"})
    g.pass(name, "test.add", {{"a", name + "@-1"}}, {{"target", name}});
  g.pass("show", "test.add", {{"a", "first"}, {"b", "second"}}, {{"target", "result"}});
  make_executor(g, 16, 16);
  bind(g, "result", {});
  // the placeholders of unbound ports, and both histories
  constexpr size_t for_clears = 2, of_passes = 4;
  ASSERT_FALSE(record());
  EXPECT_EQ(recorded.batches, for_clears + of_passes);
  recorded = {};
  ASSERT_FALSE(record());
  EXPECT_EQ(recorded.batches, of_passes) << "before each pass, and after the last";
}

TEST_F(CommandsTest, CountersShareTheBarrierCallsOfPasses) {
  counters = true;
  SmallGraph g{"export first", "export second", "export third"};
  for (const char* name : {"first", "second", "third"})
    g.pass(name, "test.count", {}, {{"target", name}});
  make_executor(g, 16, 16);
  for (const char* name : {"first", "second", "third"})
    bind(g, name, {});
  ASSERT_FALSE(record());
  EXPECT_EQ(recorded.batches, 4u) << "one before each pass, one after the last";
  EXPECT_EQ(recorded.all_memory_count, 3u) << "the first pass follows no other that counts";
  EXPECT_EQ(recorded.dispatches_before_it, 3u);
  EXPECT_EQ(recorded.all_memory.srcStageMask, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT);
  EXPECT_EQ(recorded.all_memory.srcAccessMask, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT);
  EXPECT_EQ(recorded.all_memory.dstStageMask, VK_PIPELINE_STAGE_2_HOST_BIT);
  EXPECT_EQ(recorded.all_memory.dstAccessMask, VK_ACCESS_2_HOST_READ_BIT);
}

TEST_F(CommandsTest, GroupsCoverTheRenderRectangleAndEveryPassHasALabel) {
  const SmallGraph g = update();
  make_executor(g, 100, 50);
  bind(g, "light", {});
  ASSERT_FALSE(record());
  EXPECT_EQ(recorded.dispatches, 2u);
  EXPECT_EQ(recorded.labels, 2u);
  EXPECT_THAT(recorded.groups, ElementsAre(13, 7, 1));
  ASSERT_FALSE(record({5, 5, 17, 8}));
  EXPECT_THAT(recorded.groups, ElementsAre(3, 1, 1));
}

} // namespace
} // namespace dermis::testing
