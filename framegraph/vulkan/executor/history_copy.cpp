// Copies the histories that another plan's executor holds into the histories of this plan.
#include "framegraph/vulkan/create_infos.hpp"
#include "framegraph/vulkan/executor/state.hpp"

#include <algorithm>

namespace dermis::vulkan {
namespace {

// Stages and accesses of the commands that copy.
struct CopyScope {
  VkPipelineStageFlags2 stages;
  VkAccessFlags2 reads, writes;
};
constexpr CopyScope transfer{VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_READ_BIT,
                             VK_ACCESS_2_TRANSFER_WRITE_BIT};
constexpr CopyScope rescaling{VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                              VK_ACCESS_2_SHADER_SAMPLED_READ_BIT,
                              VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT};

// The number of kept frames may differ; the texel layout may not.
bool same_texels(const PlanResource& a, const PlanResource& b) {
  return a.type == b.type && a.format == b.format && a.mips == b.mips && a.layers == b.layers &&
         a.first_instance != no_instance && b.first_instance != no_instance;
}

bool same_size(const PlanResource& a, const PlanResource& b) {
  return a.width == b.width && a.height == b.height && a.bytes == b.bytes;
}

VkImageMemoryBarrier2 layout_change(VkImage image, const VkImageSubresourceRange& range,
                                    VkImageLayout from, VkImageLayout to) {
  VkImageMemoryBarrier2 out{};
  out.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2;
  out.oldLayout = from;
  out.newLayout = to;
  out.srcQueueFamilyIndex = out.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  out.image = image;
  out.subresourceRange = range;
  return out;
}

// Records a barrier. `before`: makes all earlier writes visible to the copy; otherwise: makes the
// copy visible to all later commands.
void submit(const FunctionTable& vk, VkCommandBuffer commands, const CopyScope& copy,
            VkImageMemoryBarrier2* images, uint32_t count, bool before) {
  VkMemoryBarrier2 memory{};
  memory.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2;
  memory.srcStageMask = before ? all_commands : copy.stages;
  memory.srcAccessMask = before ? VK_ACCESS_2_MEMORY_WRITE_BIT : copy.writes;
  memory.dstStageMask = before ? copy.stages : all_commands;
  memory.dstAccessMask = before ? copy.reads | copy.writes : all_memory;
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
  vk.vkCmdPipelineBarrier2(commands, &info);
}

void copy_buffer(const FunctionTable& vk, VkCommandBuffer commands, const PlanResource& resource,
                 VkBuffer from, VkBuffer to) {
  submit(vk, commands, transfer, nullptr, 0, true);
  const VkBufferCopy all{0, 0, resource.bytes};
  vk.vkCmdCopyBuffer(commands, from, to, 1, &all);
  submit(vk, commands, transfer, nullptr, 0, false);
}

struct HistoryFrame { // one frame of a history
  const State& state;
  const PlanHistory& history;
  uint32_t frames_back = 0;

  const PlanResource& resource() const { return state.plan.resources[history.resource]; }
  const Instance& instance() const {
    return state.instances[instance_of(state, resource(), frames_back)];
  }
};

// Changes the layout of each subresource range, because each range of a history has its own.
void change_layouts(const FunctionTable& vk, VkCommandBuffer commands, const CopyScope& copy,
                    const HistoryFrame& frame, VkImageLayout other, bool before) {
  for (uint32_t number = 0; number < frame.history.range_count; ++number) {
    const Plan& plan = frame.state.plan;
    const SubresourceRange& range = plan.history_ranges[frame.history.first_range + number];
    const auto own = static_cast<VkImageLayout>(
        plan.history_layouts[frame.history.first_layout +
                             frame.frames_back * frame.history.range_count + number]);
    if (!before && own == VK_IMAGE_LAYOUT_UNDEFINED) continue; // no pass accesses the range
    VkImageMemoryBarrier2 change =
        layout_change(frame.instance().image,
                      {barrier_aspects(frame.resource().format), range.first_mip, range.mips,
                       range.first_layer, range.layers},
                      before ? own : other, before ? other : own);
    submit(vk, commands, copy, &change, 1, before);
  }
}

// Discards the whole target image, because the copy replaces its contents.
void discard(const FunctionTable& vk, VkCommandBuffer commands, const CopyScope& copy,
             const HistoryFrame& to, VkImageLayout layout) {
  VkImageMemoryBarrier2 change =
      layout_change(to.instance().image,
                    {barrier_aspects(to.resource().format), 0, VK_REMAINING_MIP_LEVELS, 0,
                     VK_REMAINING_ARRAY_LAYERS},
                    VK_IMAGE_LAYOUT_UNDEFINED, layout);
  submit(vk, commands, copy, &change, 1, true);
}

void copy_image(const FunctionTable& vk, VkCommandBuffer commands, const HistoryFrame& from,
                const HistoryFrame& to) {
  constexpr VkImageLayout source = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                          target = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
  const PlanResource& size = to.resource();
  change_layouts(vk, commands, transfer, from, source, true);
  discard(vk, commands, transfer, to, target);
  for (uint32_t mip = 0; mip < size.mips; ++mip) {
    const VkImageSubresourceLayers layers{barrier_aspects(size.format), mip, 0, size.layers};
    const VkExtent3D extent{std::max(size.width >> mip, 1u), std::max(size.height >> mip, 1u), 1};
    const VkImageCopy all{layers, {0, 0, 0}, layers, {0, 0, 0}, extent};
    vk.vkCmdCopyImage(commands, from.instance().image, source, to.instance().image, target, 1,
                      &all);
  }
  change_layouts(vk, commands, transfer, to, target, false);
}

// Calls `visit(pass type, access)` for each write of the newest frame.
template <class Visit>
void for_each_write(const State& state, const PlanHistory& history, const Visit& visit) {
  for (const PlanPass& pass : state.plan.passes)
    for (uint32_t a = pass.first_access; a < pass.first_access + pass.access_count; ++a) {
      const PlanAccess& access = state.plan.accesses[a];
      if (access.resource == history.resource && access.frames_back == 0 &&
          (access.access & all_write_access) != 0)
        visit(pass.type, access);
    }
}

size_t writes_like(const State& state, const PlanHistory& history, PassTypeId type,
                   const PlanAccess& write) {
  size_t count = 0;
  for_each_write(state, history, [&](PassTypeId other, const PlanAccess& access) {
    count += other == type && access.port == write.port && access.range == write.range ? 1 : 0;
  });
  return count;
}

// Returns whether `b` has every write of `a`, as often. Other pass types may store other data, and
// a missing pass leaves data of earlier frames.
bool has_writes_of(const State& b, const PlanHistory& of_b, const State& a,
                   const PlanHistory& of_a) {
  bool all = true;
  for_each_write(a, of_a, [&](PassTypeId type, const PlanAccess& write) {
    all = all && writes_like(a, of_a, type, write) == writes_like(b, of_b, type, write);
  });
  return all;
}

bool usable(const State& to, uint32_t to_history, const State& from, uint32_t from_history) {
  const PlanHistory &new_history = to.plan.histories[to_history],
                    &old_history = from.plan.histories[from_history];
  const PlanResource &a = to.plan.resources[new_history.resource],
                     &b = from.plan.resources[old_history.resource];
  // Contents may depend on the size of the view, also if their own size does not: a kernel finds
  // the row of a tile with the width of the previous rectangle.
  const bool same_view =
      to.plan.view_width == from.plan.view_width && to.plan.view_height == from.plan.view_height;
  const bool scales = to.histories[to_history].scales && from.histories[from_history].scales;
  return to.histories[to_history].name == from.histories[from_history].name && same_texels(a, b) &&
         ((same_view && same_size(a, b)) || scales) &&
         has_writes_of(from, old_history, to, new_history) &&
         has_writes_of(to, new_history, from, old_history);
}

} // namespace

Rectangle carried_rectangle(const State& to, const State& from) noexcept {
  // The texels of the new size that rescale_history.comp fills from texels of the rectangle.
  const auto scale = [](uint32_t& first, uint32_t& side, uint32_t now, uint32_t before) {
    if (side == 0 || now == before || before == 0) return;
    // first texel whose centre lies at or beyond `edge`
    const auto texel_at = [&](int64_t edge) {
      return (2 * edge * now + before - 1) / (2 * before);
    };
    const int64_t begin = std::min<int64_t>(texel_at(first), int64_t{now} - 1),
                  end = texel_at(int64_t{first} + side);
    first = static_cast<uint32_t>(begin);
    // 0 would mean that there is no earlier frame.
    side = static_cast<uint32_t>(std::max<int64_t>(end - begin, 1));
  };
  Rectangle out = from.previous_rectangle;
  scale(out.x, out.width, to.plan.view_width, from.plan.view_width);
  scale(out.y, out.height, to.plan.view_height, from.plan.view_height);
  return out;
}

CarriedHistory carried_history(const State& to, uint32_t index, const State& from,
                               bool reset) noexcept {
  const PlanHistory& new_history = to.plan.histories[index];
  if (reset && new_history.declaration.on_cut == HistoryDeclaration::OnCut::invalidate) return {};
  for (uint32_t h = 0; h < from.plan.histories.size(); ++h) {
    const PlanHistory& old_history = from.plan.histories[h];
    if (!usable(to, index, from, h)) continue;
    const uint32_t age = from.histories[h].age;
    return {h, old_history.frames < new_history.frames ? std::min(age, old_history.frames) : age};
  }
  return {};
}

void carry_ages(State& to, const State& from, bool reset) noexcept {
  for (uint32_t h = 0; h < to.histories.size(); ++h) {
    const CarriedHistory carried = carried_history(to, h, from, reset);
    if (carried.age == 0) continue;
    to.histories[h].age = carried.age;
    to.histories[h].reason = HistoryReason::valid;
    to.histories[h].lost = from.histories[carried.history].lost;
  }
  to.previous_rectangle = carried_rectangle(to, from);
}

void record_carried(State& to, const State& from, VkCommandBuffer commands, uint32_t frame_slot,
                    bool reset) noexcept {
  const FunctionTable& vk = *to.commands;
  for (uint32_t h = 0; h < to.histories.size(); ++h) {
    const CarriedHistory carried = carried_history(to, h, from, reset);
    if (carried.age == 0) continue;
    const PlanHistory &new_history = to.plan.histories[h],
                      &old_history = from.plan.histories[carried.history];
    const PlanResource& resource = to.plan.resources[new_history.resource];
    for (uint32_t back = 1; back <= std::min({new_history.frames, old_history.frames, carried.age});
         ++back) {
      Instance& instance = to.instances[instance_of(to, resource, back)];
      const HistoryFrame source{from, old_history, back}, target{to, new_history, back};
      if (resource.type == ResourceType::buffer) {
        copy_buffer(vk, commands, resource, source.instance().buffer, instance.buffer);
      } else if (same_size(source.resource(), resource)) {
        copy_image(vk, commands, source, target);
      } else {
        change_layouts(vk, commands, rescaling, source, VK_IMAGE_LAYOUT_GENERAL, true);
        discard(vk, commands, rescaling, target, VK_IMAGE_LAYOUT_GENERAL);
        record_rescaling(to, from, commands, {h, carried.history, back, frame_slot});
        change_layouts(vk, commands, rescaling, target, VK_IMAGE_LAYOUT_GENERAL, false);
      }
      instance.ready = true;
    }
  }
}

} // namespace dermis::vulkan
