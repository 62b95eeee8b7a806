// Records the plan's barriers as Vulkan barriers. The host's states fill what the plan leaves open.
#include "framegraph/vulkan/create_infos.hpp"
#include "framegraph/vulkan/executor/state.hpp"

namespace dermis::vulkan {
namespace {

constexpr VkPipelineStageFlags2 compute = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
constexpr VkAccessFlags2 shader_write =
    VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;

// Reads of a host. Any other access counts as a write.
constexpr VkAccessFlags2 host_reads =
    VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT | VK_ACCESS_2_INDEX_READ_BIT |
    VK_ACCESS_2_VERTEX_ATTRIBUTE_READ_BIT | VK_ACCESS_2_UNIFORM_READ_BIT |
    VK_ACCESS_2_INPUT_ATTACHMENT_READ_BIT | VK_ACCESS_2_SHADER_READ_BIT |
    VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT |
    VK_ACCESS_2_TRANSFER_READ_BIT | VK_ACCESS_2_HOST_READ_BIT | VK_ACCESS_2_MEMORY_READ_BIT |
    VK_ACCESS_2_SHADER_SAMPLED_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_READ_BIT |
    VK_ACCESS_2_ACCELERATION_STRUCTURE_READ_BIT_KHR;

bool foreign(const Device& device, uint32_t queue_family) {
  return queue_family != VK_QUEUE_FAMILY_IGNORED && queue_family != device.queue_family;
}

bool is_depth_only(VkImageLayout layout) {
  return layout == VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL ||
         layout == VK_IMAGE_LAYOUT_DEPTH_READ_ONLY_OPTIMAL;
}

// Returns the aspects of a host image that change layout. Passes only see depth. Stencil keeps its
// layout if depth and stencil layouts may differ; otherwise it moves with depth and returns in
// after.layout.
VkImageAspectFlags host_aspects(const Device& device, Format format, const HostImage& host) {
  const VkImageAspectFlags all = barrier_aspects(format);
  if ((all & VK_IMAGE_ASPECT_STENCIL_BIT) == 0) return all;
  const bool separate = device.separate_depth_stencil || is_depth_only(host.before.layout) ||
                        is_depth_only(host.after.layout);
  return separate ? VkImageAspectFlags{VK_IMAGE_ASPECT_DEPTH_BIT} : all;
}

struct Scopes {
  VkPipelineStageFlags2 source_stages, destination_stages;
  VkAccessFlags2 source_access, destination_access;
  VkImageLayout old_layout, new_layout;
};

struct HostStates {
  const HostState *before = nullptr, *after = nullptr; // null: the resource is not the host's
};

HostStates host_states(const FrameInput& frame, const PlanResource& resource) {
  if (resource.first_instance != no_instance) return {};
  const auto slot = static_cast<size_t>(resource.slot);
  const auto of = [](const auto& bound) { return HostStates{&bound.before, &bound.after}; };
  switch (resource.type) {
  case ResourceType::image:
    return of(frame.images[slot]);
  case ResourceType::buffer:
    return of(frame.buffers[slot]);
  case ResourceType::acceleration_structure:
    break;
  }
  return of(frame.structures[slot]);
}

Scopes scopes_of(const Device& device, const PlanBarrier& barrier, const HostStates& host) {
  Scopes s{barrier.source_stages,
           barrier.destination_stages,
           barrier.source_access,
           barrier.destination_access,
           static_cast<VkImageLayout>(barrier.old_layout),
           static_cast<VkImageLayout>(barrier.new_layout)};
  if (barrier.from_host) {
    // An acquire makes everything the host did visible to all commands, so only the order remains.
    const bool acquired = foreign(device, host.before->queue_family);
    s.source_stages = acquired ? all_commands : host.before->stages;
    s.source_access = acquired ? 0 : host.before->access;
    s.old_layout = host.before->layout;
  }
  if (barrier.to_host) {
    // the release follows and waits for all commands
    const bool released = foreign(device, host.after->queue_family);
    s.destination_stages = released ? all_commands : host.after->stages;
    s.destination_access = released ? all_memory : host.after->access;
    s.new_layout = host.after->layout;
  }
  return s;
}

// Returns whether the barrier has nothing to wait for and no layout to change. If the plan does not
// use the resource, the barrier lies between two accesses of the host. A read after reads of the
// same kind needs none, and an ownership transfer orders all accesses.
bool is_redundant(const Device& device, const PlanBarrier& barrier, const HostStates& host,
                  const Scopes& s) {
  if (s.old_layout != s.new_layout) return false;
  if (barrier.from_host && barrier.to_host)
    return s.source_stages == 0 || s.destination_stages == 0 ||
           (((s.source_access | s.destination_access) & ~host_reads) == 0 &&
            (s.destination_access & ~s.source_access) == 0 &&
            (s.destination_stages & ~s.source_stages) == 0) ||
           foreign(device, host.before->queue_family) || foreign(device, host.after->queue_family);
  if (barrier.from_host || barrier.to_host) return s.source_stages == 0 && s.source_access == 0;
  return false;
}

// Returns the subresource range. A range that is the whole resource to the plan covers the whole
// image, including mips and layers that the plan does not know.
VkImageSubresourceRange subresources(const PlanResource& resource, const SubresourceRange& range) {
  const VkImageAspectFlags aspects = barrier_aspects(resource.format);
  if (range == resource.whole())
    return {aspects, 0, VK_REMAINING_MIP_LEVELS, 0, VK_REMAINING_ARRAY_LAYERS};
  return {aspects, range.first_mip, range.mips, range.first_layer, range.layers};
}

VkImageMemoryBarrier2 image_barrier(VkImage image, VkImageAspectFlags aspects, const Scopes& s) {
  VkImageMemoryBarrier2 out{};
  out.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2;
  out.srcStageMask = s.source_stages;
  out.srcAccessMask = s.source_access;
  out.dstStageMask = s.destination_stages;
  out.dstAccessMask = s.destination_access;
  out.oldLayout = s.old_layout;
  out.newLayout = s.new_layout;
  out.srcQueueFamilyIndex = out.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  out.image = image;
  out.subresourceRange = {aspects, 0, VK_REMAINING_MIP_LEVELS, 0, VK_REMAINING_ARRAY_LAYERS};
  return out;
}

// Restricts the barrier to the layers that the host binds.
VkImageMemoryBarrier2 host_barrier(const HostImage& host, VkImageAspectFlags aspects,
                                   const Scopes& s) {
  VkImageMemoryBarrier2 out = image_barrier(host.image, aspects, s);
  out.subresourceRange.baseArrayLayer = host.first_layer;
  if (host.layers > 0) out.subresourceRange.layerCount = host.layers;
  return out;
}

VkBufferMemoryBarrier2 buffer_barrier(VkBuffer buffer, const Scopes& s) {
  VkBufferMemoryBarrier2 out{};
  out.sType = VK_STRUCTURE_TYPE_BUFFER_MEMORY_BARRIER_2;
  out.srcStageMask = s.source_stages;
  out.srcAccessMask = s.source_access;
  out.dstStageMask = s.destination_stages;
  out.dstAccessMask = s.destination_access;
  out.srcQueueFamilyIndex = out.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  out.buffer = buffer;
  out.size = VK_WHOLE_SIZE;
  return out;
}

// Restricts the barrier to the byte range that the host binds.
VkBufferMemoryBarrier2 host_barrier(const HostBuffer& host, const Scopes& s) {
  VkBufferMemoryBarrier2 out = buffer_barrier(host.buffer, s);
  out.offset = host.offset;
  out.size = host.bytes;
  return out;
}

VkMemoryBarrier2 memory_barrier(const Scopes& s) {
  return {VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
          nullptr,
          s.source_stages,
          s.source_access,
          s.destination_stages,
          s.destination_access};
}

// Number of State::..._barriers in use.
struct Batch {
  uint32_t images = 0, buffers = 0, memory = 0;
};

// Collects a global barrier for aliased memory. Earlier contents of the memory were written through
// other resources. An image or buffer barrier only covers accesses through its own resource
// (VkImageMemoryBarrier2, VkBufferMemoryBarrier2), so a global memory barrier makes those writes
// available. Both barriers name writes even if they only wait for reads. Nothing is left to make
// available then, but the validation layer (1.3.239), which ignores image padding, may have missed
// the earlier barrier.
struct AliasBarrier {
  Scopes scopes{};

  void add(Scopes& s) {
    if (s.source_stages == 0) return;
    if (s.source_access == 0)
      s.source_access = s.source_stages == compute ? VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT
                                                   : VK_ACCESS_2_MEMORY_WRITE_BIT;
    scopes.source_stages |= s.source_stages;
    scopes.source_access |= s.source_access;
    scopes.destination_stages |= s.destination_stages;
    scopes.destination_access |= s.destination_access;
  }
  bool needed() const { return scopes.source_stages != 0; }
};

void record_batch(const State& state, VkCommandBuffer commands, const Batch& batch) {
  if (batch.images == 0 && batch.buffers == 0 && batch.memory == 0) return;
  VkDependencyInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO;
  info.memoryBarrierCount = batch.memory;
  info.pMemoryBarriers = state.memory_barriers.data();
  info.imageMemoryBarrierCount = batch.images;
  info.pImageMemoryBarriers = state.image_barriers.data();
  info.bufferMemoryBarrierCount = batch.buffers;
  info.pBufferMemoryBarriers = state.buffer_barriers.data();
  state.commands->vkCmdPipelineBarrier2(commands, &info);
}

void global_barrier(const State& state, VkCommandBuffer commands, const VkMemoryBarrier2& barrier) {
  VkDependencyInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO;
  info.memoryBarrierCount = 1;
  info.pMemoryBarriers = &barrier;
  state.commands->vkCmdPipelineBarrier2(commands, &info);
}

void record_alias_barrier(const State& state, VkCommandBuffer commands,
                          AliasBarrier& alias_barrier) {
  alias_barrier.scopes.destination_stages = all_commands;
  alias_barrier.scopes.destination_access = all_memory;
  if (alias_barrier.needed()) global_barrier(state, commands, memory_barrier(alias_barrier.scopes));
  alias_barrier = {};
}

// Adds a barrier for the resource that the host binds to the slot.
void add_host_barrier(State& state, const FrameInput& frame, const PlanResource& resource,
                      const Scopes& s, Batch& batch) {
  const auto slot = static_cast<size_t>(resource.slot);
  switch (resource.type) {
  case ResourceType::image:
    state.image_barriers[batch.images++] = host_barrier(
        frame.images[slot], host_aspects(*state.device, resource.format, frame.images[slot]), s);
    break;
  case ResourceType::buffer:
    state.buffer_barriers[batch.buffers++] = host_barrier(frame.buffers[slot], s);
    break;
  case ResourceType::acceleration_structure:
    state.memory_barriers[batch.memory++] = memory_barrier(s);
    break;
  }
}

Scopes counter_scopes(CountersTo readers) {
  const bool host = readers == CountersTo::host;
  return {compute,
          host ? VK_PIPELINE_STAGE_2_HOST_BIT : compute,
          VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
          host ? VK_ACCESS_2_HOST_READ_BIT : shader_write,
          VK_IMAGE_LAYOUT_UNDEFINED,
          VK_IMAGE_LAYOUT_UNDEFINED};
}

} // namespace

uint32_t instance_of(const State& state, const PlanResource& resource,
                     uint32_t frames_back) noexcept {
  const uint32_t count = resource.instance_count;
  const auto phase = static_cast<uint32_t>(state.frame_counter % count);
  return resource.first_instance + (phase + count - frames_back % count) % count;
}

// Returns whether the barrier precedes the first write of this frame's instance of a history. Then
// other resources may have used the memory while the instance was idle.
bool begins_history(const PlanResource& resource, const PlanBarrier& barrier) {
  return resource.type == ResourceType::buffer && barrier.frames_back == 0 &&
         barrier.why == PlanBarrier::ReasonKind::history;
}

void record_barriers(State& state, const FrameInput& frame, const BarrierBatch& of) noexcept {
  Batch batch;
  AliasBarrier alias_barrier;
  for (uint32_t i = of.first; i < of.first + of.count; ++i) {
    const PlanBarrier& barrier = state.plan.barriers[i];
    const PlanResource& resource = state.plan.resources[barrier.resource];
    const bool host_owned = resource.first_instance == no_instance;
    const HostStates host = host_states(frame, resource);
    Scopes s = scopes_of(*state.device, barrier, host);
    if (is_redundant(*state.device, barrier, host, s)) continue;
    if (host_owned) {
      add_host_barrier(state, frame, resource, s, batch);
      continue;
    }
    const Instance& instance = state.instances[instance_of(state, resource, barrier.frames_back)];
    const bool discarded = discards(state.plan, barrier), poison = state.poison && discarded;
    if ((discarded || begins_history(resource, barrier)) && instance.aliased) {
      alias_barrier.add(s);
      // the fill must come after the other resource's writes
      if (poison) record_alias_barrier(state, frame.command_buffer, alias_barrier);
    }
    if (resource.type == ResourceType::image) {
      VkImageMemoryBarrier2& image = state.image_barriers[batch.images];
      image = image_barrier(instance.image, barrier_aspects(resource.format), s);
      image.subresourceRange = subresources(resource, barrier.range);
      if (poison)
        record_poison(state, frame.command_buffer, image, resource.format);
      else
        ++batch.images;
      continue;
    }
    VkBufferMemoryBarrier2& buffer = state.buffer_barriers[batch.buffers];
    buffer = buffer_barrier(instance.buffer, s);
    if (poison)
      record_poison(state, frame.command_buffer, buffer);
    else
      ++batch.buffers;
  }
  if (alias_barrier.needed())
    state.memory_barriers[batch.memory++] = memory_barrier(alias_barrier.scopes);
  if (of.counters != CountersTo::nobody)
    state.memory_barriers[batch.memory++] = memory_barrier(counter_scopes(of.counters));
  // Only the shader knows that it does not write to an unbound port, so its accesses are ordered.
  constexpr Scopes in_order{compute,
                            compute,
                            shader_write,
                            shader_write,
                            VK_IMAGE_LAYOUT_GENERAL,
                            VK_IMAGE_LAYOUT_GENERAL};
  for (const uint32_t index : of.writable_placeholders) {
    const Placeholder& placeholder = state.placeholders[index];
    if (placeholder.image != VK_NULL_HANDLE)
      state.image_barriers[batch.images++] =
          image_barrier(placeholder.image, VK_IMAGE_ASPECT_COLOR_BIT, in_order);
    else
      state.buffer_barriers[batch.buffers++] = buffer_barrier(placeholder.buffer, in_order);
  }
  record_batch(state, frame.command_buffer, batch);
}

void record_memory_acquire(State& state, const FrameInput& frame) noexcept {
  global_barrier(state, frame.command_buffer,
                 {VK_STRUCTURE_TYPE_MEMORY_BARRIER_2, nullptr, all_commands,
                  VK_ACCESS_2_MEMORY_WRITE_BIT, all_commands, all_memory});
}

namespace {

// Records releases and acquires. The host's layouts do not change.
template <class Pick>
void record_transfers(State& state, const FrameInput& frame, bool acquire, const Scopes& scopes,
                      Pick pick) {
  Batch batch;
  const uint32_t own = state.device->queue_family;
  for (size_t slot = 0; slot < state.slot_resource.size(); ++slot) {
    if (state.slot_resource[slot] == no_index) continue;
    const PlanResource& resource = state.plan.resources[state.slot_resource[slot]];
    const HostState& there = *pick(host_states(frame, resource));
    if (!foreign(*state.device, there.queue_family)) continue;
    Scopes s = scopes;
    s.old_layout = s.new_layout = there.layout;
    add_host_barrier(state, frame, resource, s, batch);
    const auto transfer = [&](auto& barrier) {
      barrier.srcQueueFamilyIndex = acquire ? there.queue_family : own;
      barrier.dstQueueFamilyIndex = acquire ? own : there.queue_family;
    };
    if (resource.type == ResourceType::image) transfer(state.image_barriers[batch.images - 1]);
    if (resource.type == ResourceType::buffer) transfer(state.buffer_barriers[batch.buffers - 1]);
  }
  record_batch(state, frame.command_buffer, batch);
}

// placeholder; replaced by each image's layout
constexpr VkImageLayout kept = VK_IMAGE_LAYOUT_UNDEFINED;

} // namespace

void record_acquires(State& state, const FrameInput& frame) noexcept {
  record_transfers(state, frame, true, {0, all_commands, 0, all_memory, kept, kept},
                   [](const HostStates& states) { return states.before; });
}

void record_releases(State& state, const FrameInput& frame) noexcept {
  record_transfers(state, frame, false,
                   {all_commands, 0, VK_ACCESS_2_MEMORY_WRITE_BIT, 0, kept, kept},
                   [](const HostStates& states) { return states.after; });
}

} // namespace dermis::vulkan
