// Frames in flight: what a reload replaces lives until the device has finished with it.

#include "tests/integration/abi/dermis_fixture.hpp"

namespace dermis::abi_test {
namespace {

// Command buffers and fences of three frames, submitted without waiting. Three, because a program is retired
// one record after its last frame: with two in flight that frame is complete before anyone could destroy it
// early.
struct InFlight : DermisTest {
  static constexpr uint32_t frames = 3;
  std::array<VkCommandBuffer, frames> commands{};
  std::array<VkFence, frames> fences{};

  void SetUp() override {
    DermisTest::SetUp();
    if (!host) return;
    dermis_context_destroy(context);
    dermis_context_desc desc = context_desc();
    desc.frames_in_flight = frames;
    ASSERT_EQ(dermis_context_create(&desc, &context), DERMIS_OK) << dermis_last_error();
    auto allocate =
        demo::vulkan_struct<VkCommandBufferAllocateInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO);
    allocate.commandPool = host->pool;
    allocate.commandBufferCount = frames;
    ASSERT_EQ(host->vk.vkAllocateCommandBuffers(host->device, &allocate, commands.data()), VK_SUCCESS);
    const auto fence = demo::vulkan_struct<VkFenceCreateInfo>(VK_STRUCTURE_TYPE_FENCE_CREATE_INFO);
    for (VkFence& made : fences)
      ASSERT_EQ(host->vk.vkCreateFence(host->device, &fence, nullptr, &made), VK_SUCCESS);
  }

  void TearDown() override {
    if (host) {
      host->vk.vkDeviceWaitIdle(host->device);
      for (const VkFence fence : fences)
        host->vk.vkDestroyFence(host->device, fence, nullptr);
      host->vk.vkFreeCommandBuffers(host->device, host->pool, frames, commands.data());
    }
    DermisTest::TearDown();
  }

  // Frame `index` (from 1): waits for the frame whose command buffer it takes, records, submits, does not
  // wait.
  void run(dermis_graph graph, const std::vector<dermis_image_binding>& bound, uint64_t index) {
    const size_t ring = index % frames;
    dermis_frame one = frame(bound);
    one.frame_index = index;
    one.completed_frame_index = index > frames ? index - frames : 0;
    if (index > frames) {
      ASSERT_EQ(host->vk.vkWaitForFences(host->device, 1, &fences[ring], VK_TRUE, UINT64_MAX), VK_SUCCESS);
      ASSERT_EQ(host->vk.vkResetFences(host->device, 1, &fences[ring]), VK_SUCCESS);
    }
    const auto begin =
        demo::vulkan_struct<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
    ASSERT_EQ(host->vk.vkBeginCommandBuffer(commands[ring], &begin), VK_SUCCESS);
    one.command_buffer = commands[ring];
    ASSERT_EQ(dermis_graph_record(graph, &one), DERMIS_OK) << dermis_last_error();
    ASSERT_EQ(host->vk.vkEndCommandBuffer(commands[ring]), VK_SUCCESS);
    auto submit = demo::vulkan_struct<VkSubmitInfo>(VK_STRUCTURE_TYPE_SUBMIT_INFO);
    submit.commandBufferCount = 1;
    submit.pCommandBuffers = &commands[ring];
    ASSERT_EQ(host->vk.vkQueueSubmit(host->queue, 1, &submit, fences[ring]), VK_SUCCESS);
    last_frame = index;
  }
};

// Plans of one graph lie in the same memory: without a wait in between, only their own barriers keep them
// apart.
TEST_F(InFlight, PlansThatTakeTurnsWaitForEachOthersMemory) {
  GraphOptions options;
  options.text = read_text("configs/graphs/skin.json");
  const dermis_graph graph = make_graph(options);
  ASSERT_NE(graph, nullptr);
  make_images(graph);
  const auto bound = bindings(graph);
  for (uint64_t index = 1; index <= 9; ++index) {
    dermis_budget budget = DERMIS_BUDGET_INIT;
    budget.milliseconds = index % 2 == 0 ? 0.001f : 0; // the fastest outcome, or the defaults
    budget.flags = DERMIS_BUDGET_METER;
    ASSERT_EQ(dermis_graph_set_budget(graph, &budget, nullptr), DERMIS_OK) << dermis_last_error();
    run(graph, bound, index);
  }
  host->vk.vkDeviceWaitIdle(host->device);
  dermis_choice choice = DERMIS_CHOICE_INIT;
  ASSERT_EQ(dermis_graph_choice(graph, 9, &choice), DERMIS_OK) << dermis_last_error();
  EXPECT_STREQ(choice.outcome, "technique=sap, variant=smooth");
  ASSERT_EQ(choice.frame_index, 9u);
}

TEST_F(InFlight, AReplacedProgramLivesUntilTheDeviceHasFinishedItsFrames) {
  const dermis_graph graph = make_graph();
  ASSERT_NE(graph, nullptr);
  make_images(graph);
  const auto bound = bindings(graph);
  const std::string text = read_text("configs/graphs/burley.json");
  const dermis_source source = source_of(text, "burley.json");
  for (uint64_t index = 1; index <= 8; ++index) {
    run(graph, bound, index);
    ASSERT_EQ(dermis_graph_reload(graph, &source, nullptr), DERMIS_OK) << dermis_last_error();
  }
  // TearDown asks the validation layer, which knows when an object in use was destroyed.
}

TEST_F(InFlight, FramesFollowEachOtherWithoutWaiting) {
  const dermis_graph graph = make_graph();
  ASSERT_NE(graph, nullptr);
  make_images(graph);
  const auto bound = bindings(graph);
  for (uint64_t index = 1; index <= 6; ++index)
    run(graph, bound, index);
  host->vk.vkDeviceWaitIdle(host->device);
  std::array<dermis_pass_timing, 16> times{};
  times[0].struct_size = sizeof times[0];
  uint32_t count = 16;
  ASSERT_EQ(dermis_graph_timings(graph, 6, &count, times.data()), DERMIS_OK) << dermis_last_error();
  EXPECT_EQ(times[0].frame_index, 6u);
  ASSERT_EQ(dermis_graph_timings(graph, 5, &count, times.data()), DERMIS_OK) << dermis_last_error();
  EXPECT_EQ(times[0].frame_index, 5u);
}

} // namespace
} // namespace dermis::abi_test
