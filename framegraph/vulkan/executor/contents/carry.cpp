// What another plan of the same graph kept of earlier frames, copied to where this plan expects it.
#include "framegraph/vulkan/create_infos.hpp"
#include "framegraph/vulkan/executor/state.hpp"

#include <algorithm>

namespace dermis::vulkan {
namespace {

constexpr VkPipelineStageFlags2 all_commands = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
constexpr VkPipelineStageFlags2 transfer = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
constexpr VkAccessFlags2 all_memory = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;

bool same_contents(const PlanResource& a, const PlanResource& b) {
  return a.declared == b.declared && a.type == b.type && a.format == b.format && a.width == b.width &&
         a.height == b.height && a.mips == b.mips && a.layers == b.layers && a.bytes == b.bytes &&
         a.first_instance != no_instance && b.first_instance != no_instance;
}

VkImageMemoryBarrier2 layout_change(VkImage image, VkImageAspectFlags aspects, VkImageLayout from,
                                    VkImageLayout to) {
  VkImageMemoryBarrier2 out{};
  out.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2;
  out.oldLayout = from;
  out.newLayout = to;
  out.srcQueueFamilyIndex = out.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  out.image = image;
  out.subresourceRange = {aspects, 0, VK_REMAINING_MIP_LEVELS, 0, VK_REMAINING_ARRAY_LAYERS};
  return out;
}

// Before: all that earlier commands wrote is seen; after: all later commands see the copy.
void submit(const Device& device, VkCommandBuffer commands, VkImageMemoryBarrier2* images, uint32_t count,
            bool before) {
  VkMemoryBarrier2 memory{};
  memory.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2;
  memory.srcStageMask = before ? all_commands : transfer;
  memory.srcAccessMask = before ? VK_ACCESS_2_MEMORY_WRITE_BIT : VK_ACCESS_2_TRANSFER_WRITE_BIT;
  memory.dstStageMask = before ? transfer : all_commands;
  memory.dstAccessMask = before ? VK_ACCESS_2_TRANSFER_READ_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT : all_memory;
  for (uint32_t i = 0; i < count; ++i) {
    images[i].srcStageMask = memory.srcStageMask;
    images[i].srcAccessMask = memory.srcAccessMask;
    images[i].dstStageMask = memory.dstStageMask;
    images[i].dstAccessMask = memory.dstAccessMask;
  }
  VkDependencyInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO;
  info.memoryBarrierCount = 1;
  info.pMemoryBarriers = &memory;
  info.imageMemoryBarrierCount = count;
  info.pImageMemoryBarriers = images;
  device.vk.vkCmdPipelineBarrier2(commands, &info);
}

void copy_buffer(const Device& device, VkCommandBuffer commands, const PlanResource& resource, VkBuffer from,
                 VkBuffer to) {
  submit(device, commands, nullptr, 0, true);
  const VkBufferCopy all{0, 0, resource.bytes};
  device.vk.vkCmdCopyBuffer(commands, from, to, 1, &all);
  submit(device, commands, nullptr, 0, false);
}

struct Place {
  VkImage image;
  VkImageLayout layout; // that it is in, or shall be in afterwards
};

void copy_image(const Device& device, VkCommandBuffer commands, const PlanResource& resource, Place from,
                Place to) {
  constexpr VkImageLayout source = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                          target = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
  const VkImageAspectFlags aspects = barrier_aspects(resource.format);
  VkImageMemoryBarrier2 before[] = {layout_change(from.image, aspects, from.layout, source),
                                    layout_change(to.image, aspects, VK_IMAGE_LAYOUT_UNDEFINED, target)};
  submit(device, commands, before, 2, true);
  for (uint32_t mip = 0; mip < resource.mips; ++mip) {
    const VkImageSubresourceLayers layers{aspects, mip, 0, resource.layers};
    const VkImageCopy all{layers,
                          {0, 0, 0},
                          layers,
                          {0, 0, 0},
                          {std::max(resource.width >> mip, 1u), std::max(resource.height >> mip, 1u), 1}};
    device.vk.vkCmdCopyImage(commands, from.image, source, to.image, target, 1, &all);
  }
  VkImageMemoryBarrier2 after[] = {layout_change(to.image, aspects, target, to.layout)};
  submit(device, commands, after, 1, false);
}

VkImageLayout layout_of(const State& state, const PlanHistory& history, uint32_t back) {
  return static_cast<VkImageLayout>(state.plan.history_layouts[history.first_layout + back]);
}

} // namespace

CarriedHistory carried_history(const State& to, uint32_t index, const State& from, bool reset) noexcept {
  const PlanHistory& wanted = to.plan.histories[index];
  if (reset && wanted.declaration.on_cut == HistoryDeclaration::OnCut::invalidate) return {};
  for (uint32_t h = 0; h < from.plan.histories.size(); ++h) {
    const PlanHistory& kept = from.plan.histories[h];
    if (!same_contents(to.plan.resources[wanted.resource], from.plan.resources[kept.resource])) continue;
    const uint32_t age = from.histories[h].age;
    return {h, kept.frames < wanted.frames ? std::min(age, kept.frames) : age};
  }
  return {};
}

void carry_ages(State& to, const State& from, bool reset) noexcept {
  for (uint32_t h = 0; h < to.histories.size(); ++h) {
    const CarriedHistory carried = carried_history(to, h, from, reset);
    if (carried.age == 0) continue;
    to.histories[h].age = carried.age;
    to.histories[h].reason = HistoryReason::valid;
  }
  to.previous_rectangle = from.previous_rectangle;
}

void record_carried(State& to, const State& from, VkCommandBuffer commands, bool reset) noexcept {
  for (uint32_t h = 0; h < to.histories.size(); ++h) {
    const CarriedHistory carried = carried_history(to, h, from, reset);
    if (carried.age == 0) continue;
    const PlanHistory &wanted = to.plan.histories[h], &kept = from.plan.histories[carried.history];
    const PlanResource& resource = to.plan.resources[wanted.resource];
    for (uint32_t back = 1; back <= std::min({wanted.frames, kept.frames, carried.age}); ++back) {
      Instance& target = to.instances[instance_of(to, resource, back)];
      const Instance& source = from.instances[instance_of(from, from.plan.resources[kept.resource], back)];
      if (resource.type == ResourceType::buffer)
        copy_buffer(*to.device, commands, resource, source.buffer, target.buffer);
      else
        copy_image(*to.device, commands, resource, {source.image, layout_of(from, kept, back)},
                   {target.image, layout_of(to, wanted, back)});
      target.ready = true;
    }
  }
}

} // namespace dermis::vulkan
