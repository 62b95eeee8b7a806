// Manages descriptor set 0 of every pass, once per frame in flight. Sets are allocated at creation
// and written each frame, because the host's images and the current history instances change.
#include "framegraph/vulkan/executor/state.hpp"

#include <algorithm>
#include <array>

namespace dermis::vulkan {
namespace {

void list_ports(State& state, const PassTypeRegistry& pass_types) {
  for (uint32_t p = 0; p < state.passes.size(); ++p) {
    Pass& pass = state.passes[p];
    if (pass.kernel == no_index) continue;
    const Kernel& kernel = *state.kernels[pass.kernel];
    for (uint32_t port = 0; port < kernel.ports.size(); ++port) {
      if (!kernel.ports[port].type) continue;
      PortWrite write;
      write.pass = p;
      write.port = port;
      if ((pass.port_mask >> port & 1u) == 0) {
        const bool writes = usage_info(pass_types[kernel.type].ports[port].usage).writes;
        write.placeholder = placeholder_for(state, kernel.ports[port], writes);
        if (writes &&
            std::find(pass.writable_placeholders.begin(), pass.writable_placeholders.end(),
                      write.placeholder) == pass.writable_placeholders.end())
          pass.writable_placeholders.push_back(write.placeholder);
      }
      state.descriptors.ports.push_back(write);
    }
  }
}

void prepare_writes(State& state) {
  Descriptors& d = state.descriptors;
  d.writes.resize(d.ports.size());
  d.images.resize(d.ports.size());
  d.buffers.resize(d.ports.size());
  d.structures.resize(d.ports.size());
  d.handles.resize(d.ports.size());
  for (size_t i = 0; i < d.ports.size(); ++i) {
    const PortWrite& port = d.ports[i];
    const Pass& pass = state.passes[port.pass];
    VkWriteDescriptorSet& write = d.writes[i];
    write.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
    write.dstBinding = port.port;
    write.descriptorCount = 1;
    write.descriptorType = *state.kernels[pass.kernel]->ports[port.port].type;
    write.pImageInfo = &d.images[i];
    write.pBufferInfo = &d.buffers[i];
    d.buffers[i] = {VK_NULL_HANDLE, 0, VK_WHOLE_SIZE};
    d.structures[i] = {VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET_ACCELERATION_STRUCTURE_KHR, nullptr,
                       1, &d.handles[i]};
    if (write.descriptorType == VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR)
      write.pNext = &d.structures[i];
  }
}

Error create_sets(State& state) {
  const Device& device = *state.device;
  Descriptors& d = state.descriptors;
  constexpr std::array types{VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE, VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,
                             VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                             VK_DESCRIPTOR_TYPE_ACCELERATION_STRUCTURE_KHR};
  std::vector<VkDescriptorPoolSize> sizes;
  for (const VkDescriptorType type : types) {
    uint32_t count = 0;
    for (const VkWriteDescriptorSet& write : d.writes)
      count += write.descriptorType == type ? 1 : 0;
    if (count > 0) sizes.push_back({type, count * state.frames_in_flight});
  }
  std::vector<VkDescriptorSetLayout> layouts;
  for (uint32_t slot = 0; slot < state.frames_in_flight; ++slot)
    for (const Pass& pass : state.passes)
      if (pass.kernel != no_index) layouts.push_back(state.kernels[pass.kernel]->set_layout);
  if (layouts.empty()) return {};
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
  std::vector<VkDescriptorSet> sets(layouts.size(), VK_NULL_HANDLE);
  VkDescriptorSetAllocateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO;
  info.descriptorPool = d.pool;
  info.descriptorSetCount = static_cast<uint32_t>(layouts.size());
  info.pSetLayouts = layouts.data();
  result = device.vk.vkAllocateDescriptorSets(device.device, &info, sets.data());
  if (result != VK_SUCCESS) return call_error(result, "vkAllocateDescriptorSets", "ports");
  size_t next = 0;
  d.sets.assign(state.frames_in_flight * state.passes.size(), VK_NULL_HANDLE);
  for (uint32_t slot = 0; slot < state.frames_in_flight; ++slot)
    for (size_t p = 0; p < state.passes.size(); ++p)
      if (state.passes[p].kernel != no_index) d.sets[slot * state.passes.size() + p] = sets[next++];
  return {};
}

} // namespace

Error create_descriptors(State& state, const PassTypeRegistry& pass_types) {
  list_ports(state, pass_types);
  prepare_writes(state);
  return create_sets(state);
}

void destroy_descriptors(State& state) {
  const Device& device = *state.device;
  device.vk.vkDestroyDescriptorPool(device.device, state.descriptors.pool, device.allocator);
}

void write_descriptors(State& state, uint32_t frame_slot, const FrameInput& frame) noexcept {
  Descriptors& d = state.descriptors;
  for (size_t i = 0; i < d.ports.size(); ++i) {
    const PortWrite& port = d.ports[i];
    d.writes[i].dstSet = d.sets[frame_slot * state.passes.size() + port.pass];
    const uint32_t index = access_now(state, state.passes[port.pass].ports[port.port]);
    if (index == no_index) {
      d.images[i].imageView = state.placeholders[port.placeholder].view;
      d.images[i].imageLayout = VK_IMAGE_LAYOUT_GENERAL; // layout of all placeholders
      d.buffers[i].buffer = state.placeholders[port.placeholder].buffer;
      continue;
    }
    const PlanAccess& access = state.plan.accesses[index];
    const PlanResource& resource = state.plan.resources[access.resource];
    d.images[i].imageLayout = static_cast<VkImageLayout>(access.layout);
    if (resource.first_instance == no_instance) {
      const auto slot = static_cast<size_t>(resource.slot);
      if (resource.type == ResourceType::image) d.images[i].imageView = frame.images[slot].view;
      if (resource.type == ResourceType::buffer)
        d.buffers[i] = {frame.buffers[slot].buffer, frame.buffers[slot].offset,
                        frame.buffers[slot].bytes};
      if (resource.type == ResourceType::acceleration_structure)
        d.handles[i] = frame.structures[slot].structure;
      continue;
    }
    const uint32_t number = instance_of(state, resource, access.frames_back);
    const Instance& instance = state.instances[number];
    const uint32_t first_view = state.view_of_access[index];
    const bool sampled = d.writes[i].descriptorType == VK_DESCRIPTOR_TYPE_SAMPLED_IMAGE;
    d.images[i].imageView =
        first_view != no_index
            ? state.subresource_views[first_view + number - resource.first_instance].view
        : sampled ? instance.all_mips
                  : instance.first_mip;
    d.buffers[i].buffer = instance.buffer;
  }
  if (!d.writes.empty())
    state.device->vk.vkUpdateDescriptorSets(
        state.device->device, static_cast<uint32_t>(d.writes.size()), d.writes.data(), 0, nullptr);
}

} // namespace dermis::vulkan
