// Manages descriptor set 0 of every pass. A pass has one set per frame in flight and phase of its
// histories, so that the descriptors of the executor's own resources are written once. Recording
// writes descriptors of the host's resources and of conditional ports, where they changed.
#include "framegraph/vulkan/executor/state.hpp"

#include <algorithm>
#include <array>
#include <numeric>

namespace dermis::vulkan {
namespace {

// A pass with more phases rewrites the descriptors of its histories in every frame. Histories of
// the shipped graphs alternate between two instances.
constexpr uint32_t max_phases = 8;

uint32_t instance_count(const State& state, uint32_t access) {
  const PlanResource& resource = state.plan.resources[state.plan.accesses[access].resource];
  return resource.first_instance == no_instance ? 1 : resource.instance_count;
}

// Returns the number of frames after which the pass binds the same instances again.
uint32_t count_phases(const State& state, const Pass& pass) {
  uint32_t phases = 1;
  for (const PortAccess& port : pass.ports)
    for (const uint32_t access : {port.access, port.otherwise})
      if (access != no_index) phases = std::lcm(phases, instance_count(state, access));
  return phases <= max_phases ? phases : 1;
}

// Returns whether recording has to compare the port's descriptor with what its set holds.
bool is_checked(const State& state, const PortAccess& port, uint32_t phases) {
  if (port.access == no_index) return false; // a placeholder
  const PlanAccess& access = state.plan.accesses[port.access];
  return port.history != no_index ||
         state.plan.resources[access.resource].first_instance == no_instance ||
         phases % instance_count(state, port.access) != 0;
}

PortWrite make_port(State& state, const PassTypeRegistry& pass_types, Pass& pass, uint32_t port) {
  const Kernel& kernel = *state.kernels[pass.kernel];
  PortWrite write;
  write.port = port;
  write.type = *kernel.ports[port].type;
  if ((pass.port_mask >> port & 1u) != 0) return write;
  const bool writes = usage_info(pass_types[kernel.type].ports[port].usage).writes;
  write.placeholder = placeholder_for(state, kernel.ports[port], writes);
  std::vector<uint32_t>& writable = pass.writable_placeholders;
  if (writes && std::find(writable.begin(), writable.end(), write.placeholder) == writable.end())
    writable.push_back(write.placeholder);
  return write;
}

// Fills everything except the handles of sets.
void list_ports(State& state, const PassTypeRegistry& pass_types) {
  Descriptors& d = state.descriptors;
  uint32_t sets = 0, bound = 0;
  for (Pass& pass : state.passes) {
    PassSets& of_pass = d.passes.emplace_back();
    if (pass.kernel == no_index) continue;
    const Kernel& kernel = *state.kernels[pass.kernel];
    of_pass.phases = count_phases(state, pass);
    of_pass.first_port = static_cast<uint32_t>(d.ports.size());
    of_pass.first_set = sets;
    of_pass.first_bound = bound;
    for (const bool checked : {true, false})
      for (uint32_t port = 0; port < kernel.ports.size(); ++port) {
        if (!kernel.ports[port].type ||
            is_checked(state, pass.ports[port], of_pass.phases) != checked)
          continue;
        d.ports.push_back(make_port(state, pass_types, pass, port));
        of_pass.checked_count += checked ? 1 : 0;
      }
    of_pass.port_count = static_cast<uint32_t>(d.ports.size()) - of_pass.first_port;
    const uint32_t count = state.frames_in_flight * of_pass.phases;
    sets += count;
    bound += count * of_pass.checked_count;
  }
  d.is_written.assign(sets, 0);
  d.bound.resize(bound);
}

void prepare_writes(Descriptors& d) {
  d.writes.resize(d.ports.size());
  d.images.resize(d.ports.size());
  d.buffers.resize(d.ports.size());
  d.structures.resize(d.ports.size());
  d.handles.resize(d.ports.size());
  for (size_t i = 0; i < d.ports.size(); ++i) {
    VkWriteDescriptorSet& write = d.writes[i];
    write.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
    write.descriptorCount = 1;
    write.pImageInfo = &d.images[i];
    write.pBufferInfo = &d.buffers[i];
    d.structures[i] = {VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET_ACCELERATION_STRUCTURE_KHR, nullptr,
                       1, &d.handles[i]};
  }
}

Error create_sets(State& state) {
  const Device& device = *state.device;
  Descriptors& d = state.descriptors;
  constexpr std::array types{VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,
                             VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                             VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR};
  std::array<VkDescriptorPoolSize, types.size()> counts{};
  std::vector<VkDescriptorSetLayout> layouts;
  for (size_t p = 0; p < state.passes.size(); ++p) {
    const PassSets& of_pass = d.passes[p];
    if (state.passes[p].kernel == no_index) continue;
    const uint32_t count = state.frames_in_flight * of_pass.phases;
    layouts.insert(layouts.end(), count, state.kernels[state.passes[p].kernel]->set_layout);
    for (uint32_t i = 0; i < of_pass.port_count; ++i)
      for (size_t type = 0; type < types.size(); ++type)
        if (d.ports[of_pass.first_port + i].type == types[type])
          counts[type].descriptorCount += count;
  }
  if (layouts.empty()) return {};
  std::vector<VkDescriptorPoolSize> sizes;
  for (size_t type = 0; type < types.size(); ++type)
    if (counts[type].descriptorCount > 0)
      sizes.push_back({types[type], counts[type].descriptorCount});
  VkDescriptorPoolCreateInfo pool{};
  pool.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
  pool.maxSets = static_cast<uint32_t>(layouts.size());
  pool.poolSizeCount = static_cast<uint32_t>(sizes.size());
  pool.pPoolSizes = sizes.data();
  VkResult result =
      device.vk.vkCreateDescriptorPool(device.device, &pool, device.allocator, &d.pool);
  if (result != VK_SUCCESS) {
    d.pool = VK_NULL_HANDLE;
    return call_error(result, "vkCreateDescriptorPool", "ports");
  }
  d.sets.assign(layouts.size(), VK_NULL_HANDLE);
  VkDescriptorSetAllocateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO;
  info.descriptorPool = d.pool;
  info.descriptorSetCount = static_cast<uint32_t>(layouts.size());
  info.pSetLayouts = layouts.data();
  result = device.vk.vkAllocateDescriptorSets(device.device, &info, d.sets.data());
  return call_error(result, "vkAllocateDescriptorSets", "ports");
}

BoundPort bound_to_host(const PlanAccess& access, const PlanResource& resource,
                        const FrameInput& frame) {
  const auto slot = static_cast<size_t>(resource.slot);
  BoundPort now;
  switch (resource.type) {
  case ResourceType::image: {
    const HostImage& image = frame.images[slot];
    now.view = image.view;
    now.layout = static_cast<VkImageLayout>(access.layout);
    now.content_id = image.content_id;
    now.view_id = image.view_id;
    now.comparable = image.content_id != 0;
    break;
  }
  case ResourceType::buffer:
    now.buffer = frame.buffers[slot].buffer;
    now.offset = frame.buffers[slot].offset;
    now.bytes = frame.buffers[slot].bytes;
    now.comparable = false;
    break;
  case ResourceType::acceleration_structure:
    now.structure = frame.structures[slot].structure;
    now.comparable = false;
    break;
  }
  return now;
}

// Returns what the port binds in the current frame.
BoundPort bound_now(const State& state, const Pass& pass, const PortWrite& port,
                    const FrameInput& frame) {
  BoundPort now;
  const uint32_t index = access_now(state, pass.ports[port.port]);
  if (index == no_index) {
    now.view = state.placeholders[port.placeholder].view;
    now.layout = VK_IMAGE_LAYOUT_GENERAL; // layout of all placeholders
    now.buffer = state.placeholders[port.placeholder].buffer;
    return now;
  }
  const PlanAccess& access = state.plan.accesses[index];
  const PlanResource& resource = state.plan.resources[access.resource];
  if (resource.first_instance == no_instance) return bound_to_host(access, resource, frame);
  const uint32_t number = instance_of(state, resource, access.frames_back);
  const Instance& instance = state.instances[number];
  const uint32_t first_view = state.view_of_access[index];
  now.view = first_view != no_index
                 ? state.subresource_views[first_view + number - resource.first_instance].view
             : port.type == VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE ? instance.all_mips
                                                             : instance.first_mip;
  now.layout = static_cast<VkImageLayout>(access.layout);
  now.buffer = instance.buffer;
  return now;
}

void fill_write(Descriptors& d, uint32_t number, VkDescriptorSet set, const PortWrite& port,
                const BoundPort& bound) {
  VkWriteDescriptorSet& write = d.writes[number];
  write.dstSet = set;
  write.dstBinding = port.port;
  write.descriptorType = port.type;
  write.pNext =
      port.type == VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR ? &d.structures[number] : nullptr;
  d.images[number].imageView = bound.view;
  d.images[number].imageLayout = bound.layout;
  d.buffers[number] = {bound.buffer, bound.offset, bound.bytes};
  d.handles[number] = bound.structure;
}

} // namespace

Error create_descriptors(State& state, const PassTypeRegistry& pass_types) {
  list_ports(state, pass_types);
  prepare_writes(state.descriptors);
  return create_sets(state);
}

void destroy_descriptors(State& state) {
  const Device& device = *state.device;
  device.vk.vkDestroyDescriptorPool(device.device, state.descriptors.pool, device.allocator);
}

uint32_t set_index(const State& state, size_t pass, uint32_t frame_slot) noexcept {
  const PassSets& of_pass = state.descriptors.passes[pass];
  return of_pass.first_set + frame_slot * of_pass.phases +
         static_cast<uint32_t>(state.frame_counter % of_pass.phases);
}

void write_descriptors(State& state, uint32_t frame_slot, const FrameInput& frame) noexcept {
  Descriptors& d = state.descriptors;
  uint32_t count = 0;
  for (size_t p = 0; p < state.passes.size(); ++p) {
    const Pass& pass = state.passes[p];
    const PassSets& of_pass = d.passes[p];
    if (pass.kernel == no_index) continue;
    const uint32_t set = set_index(state, p, frame_slot);
    const bool is_new = d.is_written[set] == 0;
    d.is_written[set] = 1;
    BoundPort* const bound =
        d.bound.data() + of_pass.first_bound + (set - of_pass.first_set) * of_pass.checked_count;
    for (uint32_t i = 0; i < (is_new ? of_pass.port_count : of_pass.checked_count); ++i) {
      const PortWrite& port = d.ports[of_pass.first_port + i];
      const BoundPort now = bound_now(state, pass, port, frame);
      if (!is_new && now.comparable && now == bound[i]) continue;
      if (i < of_pass.checked_count) bound[i] = now;
      fill_write(d, count++, d.sets[set], port, now);
    }
  }
  if (count > 0)
    state.device->vk.vkUpdateDescriptorSets(state.device->device, count, d.writes.data(), 0,
                                            nullptr);
}

} // namespace dermis::vulkan
