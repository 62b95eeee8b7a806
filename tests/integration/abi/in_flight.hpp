#pragma once
// Three frames in flight: command buffers are submitted without waiting for earlier ones.

#include "tests/integration/abi/dermis_fixture.hpp"

namespace dermis::abi_test {

// Three, because a plan is retired one record after its last frame: with two frames in flight, the
// last frame is complete before an early destruction could be detected.
struct InFlightTest : DermisTest {
  static constexpr uint32_t frames = 3;
  std::array<VkCommandBuffer, frames> commands{};
  std::array<VkFence, frames> fences{};

  void SetUp() override;
  void TearDown() override;

  // Submits frame `index` (from 1, without gaps): waits for the frame that used the command buffer,
  // calls `record`, and submits without waiting.
  void submit(uint64_t index, const std::function<void(VkCommandBuffer)>& record);
  static uint64_t completed_before(uint64_t index) { return index > frames ? index - frames : 0; }
  void wait() const { host->vk.vkDeviceWaitIdle(host->device); }
};

} // namespace dermis::abi_test
