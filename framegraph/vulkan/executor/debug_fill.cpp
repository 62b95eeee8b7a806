// Fills undefined memory so that reads of it are detected. The fill is recorded between two halves
// of the barrier that discards the contents.
#include "framegraph/vulkan/executor/state.hpp"

#include <limits>

namespace dermis::vulkan {
namespace {

// the pattern of debugging allocators; -4.3e8 as a float
constexpr uint32_t poison_word = 0xcdcdcdcd;

bool is_unsigned(Format format) {
  return format_info(format).name.find("_uint") != std::string_view::npos;
}

template <class Barrier> Barrier until_fill(Barrier barrier) {
  barrier.dstStageMask = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
  barrier.dstAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT;
  return barrier;
}

template <class Barrier> Barrier from_fill(Barrier barrier) {
  barrier.srcStageMask = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
  barrier.srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT;
  return barrier;
}

void record(State& state, VkCommandBuffer commands, const VkImageMemoryBarrier2* image,
            const VkBufferMemoryBarrier2* buffer) {
  VkDependencyInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO;
  info.imageMemoryBarrierCount = image ? 1 : 0;
  info.pImageMemoryBarriers = image;
  info.bufferMemoryBarrierCount = buffer ? 1 : 0;
  info.pBufferMemoryBarriers = buffer;
  state.commands->vkCmdPipelineBarrier2(commands, &info);
}

} // namespace

bool discards(const Plan& plan, const PlanBarrier& barrier) noexcept {
  const PlanResource& resource = plan.resources[barrier.resource];
  if (resource.first_instance == no_instance) return false;
  if (resource.type == ResourceType::image) return barrier.old_layout == Layout::undefined;
  return barrier.why == PlanBarrier::ReasonKind::first_use ||
         barrier.why == PlanBarrier::ReasonKind::alias;
}

void record_poison(State& state, VkCommandBuffer commands, const VkImageMemoryBarrier2& image,
                   Format format) noexcept {
  VkImageMemoryBarrier2 before = until_fill(image), after = from_fill(image);
  before.newLayout = after.oldLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
  VkClearColorValue value{};
  for (size_t i = 0; i < 4; ++i)
    if (is_unsigned(format))
      value.uint32[i] = poison_word;
    else
      value.float32[i] = std::numeric_limits<float>::quiet_NaN();
  record(state, commands, &before, nullptr);
  state.commands->vkCmdClearColorImage(commands, image.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                       &value, 1, &image.subresourceRange);
  record(state, commands, &after, nullptr);
}

void record_poison(State& state, VkCommandBuffer commands,
                   const VkBufferMemoryBarrier2& buffer) noexcept {
  const VkBufferMemoryBarrier2 before = until_fill(buffer), after = from_fill(buffer);
  record(state, commands, nullptr, &before);
  state.commands->vkCmdFillBuffer(commands, buffer.buffer, 0, VK_WHOLE_SIZE, poison_word);
  record(state, commands, nullptr, &after);
}

} // namespace dermis::vulkan
