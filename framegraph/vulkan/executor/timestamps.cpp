// Measures the device time of each pass. One timestamp precedes the first pass and one follows each
// pass, so that the times of the passes, including their barriers, add up to the time of the plan.
#include "framegraph/vulkan/executor/state.hpp"

#include <algorithm>

namespace dermis::vulkan {
namespace {

VkResult read_ticks(const State& state, uint32_t frame_slot,
                    std::vector<uint64_t>& ticks) noexcept {
  const Timestamps& t = state.timestamps;
  return state.device->vk.vkGetQueryPoolResults(
      state.device->device, t.pool, frame_slot * t.per_frame, t.per_frame,
      t.per_frame * sizeof(uint64_t), ticks.data(), sizeof(uint64_t), VK_QUERY_RESULT_64_BIT);
}

// Keeps the times of the slot's earlier frame, which the device has finished, so that they stay
// readable after the reset.
void keep_ticks(State& state, uint32_t frame_slot) noexcept {
  Timestamps& t = state.timestamps;
  const uint64_t frame = t.frame_of_slot[frame_slot];
  if (frame == 0) return;
  const VkResult result = read_ticks(state, frame_slot, t.ticks);
  if (result == VK_ERROR_DEVICE_LOST) state.saw_lost_device = true;
  if (result != VK_SUCCESS) return;
  t.kept.swap(t.ticks);
  t.kept_frame = frame;
}

} // namespace

Error create_timestamps(State& state) {
  const Device& device = *state.device;
  Timestamps& t = state.timestamps;
  if (!device.timings || state.passes.empty()) return {};
  t.per_frame = static_cast<uint32_t>(state.passes.size()) + 1;
  t.frame_of_slot.assign(state.frames_in_flight, 0);
  t.ticks.assign(t.per_frame, 0);
  t.kept.assign(t.per_frame, 0);
  VkQueryPoolCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO;
  info.queryType = VK_QUERY_TYPE_TIMESTAMP;
  info.queryCount = t.per_frame * state.frames_in_flight;
  const VkResult result =
      device.vk.vkCreateQueryPool(device.device, &info, device.allocator, &t.pool);
  if (result != VK_SUCCESS) t.pool = VK_NULL_HANDLE;
  return call_error(result, "vkCreateQueryPool", "timestamps");
}

void begin_timestamps(State& state, VkCommandBuffer commands, uint32_t frame_slot) noexcept {
  Timestamps& t = state.timestamps;
  if (t.pool == VK_NULL_HANDLE) return;
  keep_ticks(state, frame_slot);
  state.commands->vkCmdResetQueryPool(commands, t.pool, frame_slot * t.per_frame, t.per_frame);
  write_timestamp(state, commands, frame_slot, 0);
}

void write_timestamp(State& state, VkCommandBuffer commands, uint32_t frame_slot,
                     uint32_t index) noexcept {
  const Timestamps& t = state.timestamps;
  if (t.pool == VK_NULL_HANDLE) return;
  state.commands->vkCmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, t.pool,
                                       frame_slot * t.per_frame + index);
}

bool Executor::read_timings(uint64_t completed_frame_index, uint64_t& frame_index,
                            std::span<PassTiming> timings) noexcept {
  State& state = *state_;
  Timestamps& t = state.timestamps;
  if (t.pool == VK_NULL_HANDLE) return false;
  uint32_t newest = no_index;
  for (uint32_t slot = 0; slot < state.frames_in_flight; ++slot) {
    const uint64_t recorded = t.frame_of_slot[slot];
    if (recorded == 0 || recorded > completed_frame_index) continue;
    if (newest == no_index || recorded > t.frame_of_slot[newest]) newest = slot;
  }
  const bool kept = t.kept_frame != 0 && t.kept_frame <= completed_frame_index &&
                    (newest == no_index || t.frame_of_slot[newest] < t.kept_frame);
  if (kept) {
    std::copy(t.kept.begin(), t.kept.end(), t.ticks.begin());
  } else {
    if (newest == no_index) return false;
    const VkResult result = read_ticks(state, newest, t.ticks);
    if (result == VK_ERROR_DEVICE_LOST) state.saw_lost_device = true;
    if (result != VK_SUCCESS) return false;
  }
  const Device& device = *state.device;
  constexpr uint32_t all_bits = 64;
  const uint64_t mask = device.timestamp_valid_bits >= all_bits
                            ? ~uint64_t{0}
                            : (uint64_t{1} << device.timestamp_valid_bits) - 1;
  // nanoseconds per tick
  const double period = static_cast<double>(device.properties.limits.timestampPeriod);
  for (size_t p = 0; p < state.passes.size() && p < timings.size(); ++p) {
    const uint64_t ticks = (t.ticks[p + 1] - t.ticks[p]) & mask; // the mask handles timer wrap
    if (ticks > mask / 2) return false;                          // the timer went backwards
    timings[p] = {state.passes[p].name, static_cast<uint64_t>(static_cast<double>(ticks) * period)};
  }
  frame_index = kept ? t.kept_frame : t.frame_of_slot[newest];
  return true;
}

} // namespace dermis::vulkan
