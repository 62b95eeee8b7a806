// Clears memory that is read before the plan writes it: placeholders of unbound ports, and history
// instances that are new or hold frames from before a cut. All clears of a frame are recorded
// between two barrier calls; nothing is recorded if everything is ready.
#include "framegraph/vulkan/executor/state.hpp"

namespace dermis::vulkan {
namespace {

constexpr VkClearColorValue zero{};
constexpr VkImageSubresourceRange whole_image{VK_IMAGE_ASPECT_COLOR_BIT, 0, VK_REMAINING_MIP_LEVELS,
                                              0, VK_REMAINING_ARRAY_LAYERS};

// Scopes of a barrier. They contain all commands, because earlier frames may still use the memory
// and any later command may use the zeros. Clears are rare.
struct ClearScopes {
  VkPipelineStageFlags2 source_stages, destination_stages;
  VkAccessFlags2 source_access, destination_access;
};
constexpr ClearScopes before_clear{all_commands, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
                                   VK_ACCESS_2_MEMORY_WRITE_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT};
constexpr ClearScopes after_clear{VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, all_commands,
                                  VK_ACCESS_2_TRANSFER_WRITE_BIT, all_memory};
constexpr ClearScopes without_clear{all_commands, all_commands, VK_ACCESS_2_MEMORY_WRITE_BIT,
                                    all_memory};

template <class Barrier> void set_scopes(Barrier& barrier, const ClearScopes& scopes) {
  barrier.srcStageMask = scopes.source_stages;
  barrier.srcAccessMask = scopes.source_access;
  barrier.dstStageMask = scopes.destination_stages;
  barrier.dstAccessMask = scopes.destination_access;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
}

VkImageMemoryBarrier2 image_barrier(const ClearTarget& target, bool before) {
  VkImageMemoryBarrier2 barrier{};
  barrier.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2;
  set_scopes(barrier, !before ? after_clear : target.clear ? before_clear : without_clear);
  barrier.oldLayout = before ? VK_IMAGE_LAYOUT_UNDEFINED : VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
  barrier.newLayout = before && target.clear ? VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL : target.layout;
  barrier.image = target.image;
  barrier.subresourceRange = target.range;
  return barrier;
}

VkBufferMemoryBarrier2 buffer_barrier(const ClearTarget& target, bool before) {
  VkBufferMemoryBarrier2 barrier{};
  barrier.sType = VK_STRUCTURE_TYPE_BUFFER_MEMORY_BARRIER_2;
  set_scopes(barrier, !before ? after_clear : target.clear ? before_clear : without_clear);
  barrier.buffer = target.buffer;
  barrier.size = VK_WHOLE_SIZE;
  return barrier;
}

// Records the barriers of all targets before or after the clears.
void record_clear_barriers(State& state, VkCommandBuffer commands, bool before) {
  VkDependencyInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO;
  for (const ClearTarget& target : state.clear_targets) {
    if (!before && !target.clear) continue;
    if (target.image != VK_NULL_HANDLE)
      state.image_barriers[info.imageMemoryBarrierCount++] = image_barrier(target, before);
    else
      state.buffer_barriers[info.bufferMemoryBarrierCount++] = buffer_barrier(target, before);
  }
  if (info.imageMemoryBarrierCount == 0 && info.bufferMemoryBarrierCount == 0) return;
  info.pImageMemoryBarriers = state.image_barriers.data();
  info.pBufferMemoryBarriers = state.buffer_barriers.data();
  state.commands->vkCmdPipelineBarrier2(commands, &info);
}

void record_clear(const FunctionTable& vk, VkCommandBuffer commands, const ClearTarget& target) {
  if (!target.clear) return;
  if (target.image != VK_NULL_HANDLE)
    vk.vkCmdClearColorImage(commands, target.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &zero, 1,
                            &target.range);
  else
    vk.vkCmdFillBuffer(commands, target.buffer, 0, VK_WHOLE_SIZE, 0);
}

// Adds the subresource ranges of the history's instance `back` frames ago, each of which has its
// own layout.
void add_history_targets(State& state, const PlanHistory& history, uint32_t back) {
  const PlanResource& resource = state.plan.resources[history.resource];
  const Instance& instance = state.instances[instance_of(state, resource, back)];
  for (uint32_t number = 0; number < history.range_count; ++number) {
    const SubresourceRange& range = state.plan.history_ranges[history.first_range + number];
    const auto layout = static_cast<VkImageLayout>(
        state.plan.history_layouts[history.first_layout + back * history.range_count + number]);
    if (instance.image != VK_NULL_HANDLE && layout == VK_IMAGE_LAYOUT_UNDEFINED)
      continue; // no pass accesses the range
    ClearTarget& target = state.clear_targets.emplace_back();
    target.image = instance.image;
    target.buffer = instance.buffer;
    target.layout = layout;
    target.range = {VK_IMAGE_ASPECT_COLOR_BIT, range.first_mip, range.mips, range.first_layer,
                    range.layers};
    // the bit has the same value for buffers
    target.clear = (resource.vk_usage & VK_IMAGE_USAGE_TRANSFER_DST_BIT) != 0;
  }
}

} // namespace

void reserve_clear_targets(State& state) {
  size_t count = state.placeholders.size();
  for (const PlanHistory& history : state.plan.histories)
    count += size_t{history.frames} * history.range_count;
  state.clear_targets.reserve(count);
}

void record_initialisation(State& state, VkCommandBuffer commands) noexcept {
  state.clear_targets.clear();
  if (!state.placeholders_ready)
    for (const Placeholder& placeholder : state.placeholders)
      state.clear_targets.push_back(
          {placeholder.image, placeholder.buffer, VK_IMAGE_LAYOUT_GENERAL, whole_image, true});
  state.placeholders_ready = true;
  for (const PlanHistory& history : state.plan.histories) {
    const PlanResource& resource = state.plan.resources[history.resource];
    if (resource.first_instance == no_instance) continue;
    for (uint32_t back = 1; back <= history.frames; ++back) {
      Instance& instance = state.instances[instance_of(state, resource, back)];
      if (!instance.ready) add_history_targets(state, history, back);
      instance.ready = true;
    }
  }
  if (state.clear_targets.empty()) return;
  record_clear_barriers(state, commands, true);
  for (const ClearTarget& target : state.clear_targets)
    record_clear(*state.commands, commands, target);
  record_clear_barriers(state, commands, false);
}

} // namespace dermis::vulkan
