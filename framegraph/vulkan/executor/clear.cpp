// Clears memory that is read before the plan writes it: placeholders of unbound ports, and history
// instances that are new or hold frames from before a cut. Each clear is recorded between two
// barriers; nothing is recorded if everything is ready.
#include "framegraph/vulkan/executor/state.hpp"

namespace dermis::vulkan {
namespace {

constexpr VkClearColorValue zero{};
constexpr VkImageSubresourceRange whole_image{VK_IMAGE_ASPECT_COLOR_BIT, 0, VK_REMAINING_MIP_LEVELS,
                                              0, VK_REMAINING_ARRAY_LAYERS};

// Waits for all commands, because earlier frames may still use the memory and any later command may
// use the zeros. Clears are rare.
struct Target {
  VkImage image = VK_NULL_HANDLE;
  VkBuffer buffer = VK_NULL_HANDLE;
  VkImageLayout layout = VK_IMAGE_LAYOUT_UNDEFINED; // layout after the clear
  VkImageSubresourceRange range = whole_image;
  bool clear = true; // false: created without transfer usage, contents stay undefined
};

void record_barrier(const FunctionTable& vk, VkCommandBuffer commands, const Target& target,
                    bool before_clear) {
  VkImageMemoryBarrier2 image{};
  image.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2;
  image.srcStageMask =
      before_clear ? VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT : VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
  image.srcAccessMask =
      before_clear ? VK_ACCESS_2_MEMORY_WRITE_BIT : VK_ACCESS_2_TRANSFER_WRITE_BIT;
  image.dstStageMask = before_clear && target.clear ? VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT
                                                    : VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  image.dstAccessMask = before_clear && target.clear
                            ? VK_ACCESS_2_TRANSFER_WRITE_BIT
                            : VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
  image.oldLayout = before_clear ? VK_IMAGE_LAYOUT_UNDEFINED : VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
  image.newLayout =
      before_clear && target.clear ? VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL : target.layout;
  image.srcQueueFamilyIndex = image.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  image.image = target.image;
  image.subresourceRange = target.range;
  VkBufferMemoryBarrier2 buffer{};
  buffer.sType = VK_STRUCTURE_TYPE_BUFFER_MEMORY_BARRIER_2;
  buffer.srcStageMask = image.srcStageMask;
  buffer.srcAccessMask = image.srcAccessMask;
  buffer.dstStageMask = image.dstStageMask;
  buffer.dstAccessMask = image.dstAccessMask;
  buffer.srcQueueFamilyIndex = buffer.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  buffer.buffer = target.buffer;
  buffer.size = VK_WHOLE_SIZE;
  VkDependencyInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO;
  info.imageMemoryBarrierCount = target.image != VK_NULL_HANDLE ? 1 : 0;
  info.pImageMemoryBarriers = &image;
  info.bufferMemoryBarrierCount = target.buffer != VK_NULL_HANDLE ? 1 : 0;
  info.pBufferMemoryBarriers = &buffer;
  vk.vkCmdPipelineBarrier2(commands, &info);
}

void initialise(const FunctionTable& vk, VkCommandBuffer commands, const Target& target) {
  record_barrier(vk, commands, target, true);
  if (!target.clear) return;
  if (target.image != VK_NULL_HANDLE)
    vk.vkCmdClearColorImage(commands, target.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, &zero, 1,
                            &target.range);
  if (target.buffer != VK_NULL_HANDLE)
    vk.vkCmdFillBuffer(commands, target.buffer, 0, VK_WHOLE_SIZE, 0);
  record_barrier(vk, commands, target, false);
}

} // namespace

void record_initialisation(State& state, VkCommandBuffer commands) noexcept {
  const FunctionTable& vk = *state.commands;
  if (!state.placeholders_ready)
    for (const Placeholder& placeholder : state.placeholders)
      initialise(vk, commands, {placeholder.image, placeholder.buffer, VK_IMAGE_LAYOUT_GENERAL});
  state.placeholders_ready = true;
  for (const PlanHistory& history : state.plan.histories) {
    const PlanResource& resource = state.plan.resources[history.resource];
    if (resource.first_instance == no_instance) continue;
    for (uint32_t back = 1; back <= history.frames; ++back) {
      Instance& instance = state.instances[instance_of(state, resource, back)];
      if (instance.ready) continue;
      // the bit has the same value for buffers
      const bool clear = (resource.vk_usage & VK_IMAGE_USAGE_TRANSFER_DST_BIT) != 0;
      for (uint32_t number = 0; number < history.range_count; ++number) {
        const SubresourceRange& range = state.plan.history_ranges[history.first_range + number];
        const Layout layout =
            state.plan.history_layouts[history.first_layout + back * history.range_count + number];
        initialise(vk, commands,
                   {instance.image,
                    instance.buffer,
                    static_cast<VkImageLayout>(layout),
                    {VK_IMAGE_ASPECT_COLOR_BIT, range.first_mip, range.mips, range.first_layer,
                     range.layers},
                    clear});
      }
      instance.ready = true;
    }
  }
}

} // namespace dermis::vulkan
