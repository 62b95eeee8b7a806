#include "tests/integration/abi/in_flight.hpp"

namespace dermis::abi_test {

void InFlightTest::SetUp() {
  DermisTest::SetUp();
  if (!host) return;
  dermis_context_desc desc = context_desc();
  desc.frames_in_flight = frames;
  own_context(desc);
  auto allocate = demo::vulkan_struct<VkCommandBufferAllocateInfo>(
      VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO);
  allocate.commandPool = host->pool;
  allocate.commandBufferCount = frames;
  ASSERT_EQ(host->vk.vkAllocateCommandBuffers(host->device, &allocate, commands.data()),
            VK_SUCCESS);
  const auto fence = demo::vulkan_struct<VkFenceCreateInfo>(VK_STRUCTURE_TYPE_FENCE_CREATE_INFO);
  for (VkFence& made : fences)
    ASSERT_EQ(host->vk.vkCreateFence(host->device, &fence, nullptr, &made), VK_SUCCESS);
}

void InFlightTest::TearDown() {
  if (host) {
    wait();
    for (const VkFence fence : fences)
      host->vk.vkDestroyFence(host->device, fence, nullptr);
    host->vk.vkFreeCommandBuffers(host->device, host->pool, frames, commands.data());
  }
  DermisTest::TearDown();
}

void InFlightTest::submit(uint64_t index, const std::function<void(VkCommandBuffer)>& record) {
  const size_t ring = index % frames;
  if (index > frames) {
    ASSERT_EQ(host->vk.vkWaitForFences(host->device, 1, &fences[ring], VK_TRUE, UINT64_MAX),
              VK_SUCCESS);
    ASSERT_EQ(host->vk.vkResetFences(host->device, 1, &fences[ring]), VK_SUCCESS);
  }
  const auto begin =
      demo::vulkan_struct<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
  ASSERT_EQ(host->vk.vkBeginCommandBuffer(commands[ring], &begin), VK_SUCCESS);
  record(commands[ring]);
  ASSERT_EQ(host->vk.vkEndCommandBuffer(commands[ring]), VK_SUCCESS);
  auto submit = demo::vulkan_struct<VkSubmitInfo>(VK_STRUCTURE_TYPE_SUBMIT_INFO);
  submit.commandBufferCount = 1;
  submit.pCommandBuffers = &commands[ring];
  ASSERT_EQ(host->vk.vkQueueSubmit(host->queue, 1, &submit, fences[ring]), VK_SUCCESS);
}

} // namespace dermis::abi_test
