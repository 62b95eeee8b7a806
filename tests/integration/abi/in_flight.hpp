#pragma once
// Three frames in flight: command buffers that are submitted without waiting for the ones before.

#include "tests/integration/abi/dermis_fixture.hpp"

namespace dermis::abi_test {

// Three, because a program is retired one record after its last frame: with two in flight that frame is
// complete before anyone could destroy it early.
struct InFlightTest : DermisTest {
  static constexpr uint32_t frames = 3;
  std::array<VkCommandBuffer, frames> commands{};
  std::array<VkFence, frames> fences{};

  void SetUp() override;
  void TearDown() override;

  // Frame `index` (from 1, without gaps): waits for the frame whose command buffer it takes, calls `record`
  // with it, submits and does not wait.
  void submit(uint64_t index, const std::function<void(VkCommandBuffer)>& record);
  static uint64_t completed_before(uint64_t index) { return index > frames ? index - frames : 0; }
  void wait() const { host->vk.vkDeviceWaitIdle(host->device); }
};

} // namespace dermis::abi_test
