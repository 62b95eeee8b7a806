// Manages descriptor set 1: a host-visible buffer with frame constants and counters of every frame
// in flight, the view's tables, and a linear sampler.
#include "framegraph/model/align_up.hpp"
#include "framegraph/vulkan/create_infos.hpp"
#include "framegraph/vulkan/executor/state.hpp"
#include "framegraph/vulkan/shader/signature_check.hpp"

#include <algorithm>
#include <cstring>
#include <fmt/core.h>

namespace dermis::vulkan {
namespace {

Error check_bindings(const Device& device, std::span<const EnvironmentBinding> bindings) {
  const VkPhysicalDeviceLimits& limits = device.properties.limits;
  uint32_t counters = 0;
  for (size_t i = 0; i < bindings.size(); ++i) {
    const EnvironmentBinding& binding = bindings[i];
    if (binding.type == EnvironmentType::linear_sampler) continue;
    const uint64_t maximum = binding.type == EnvironmentType::uniform_buffer
                                 ? limits.maxUniformBufferRange
                                 : limits.maxStorageBufferRange;
    const bool second = binding.type == EnvironmentType::counters && ++counters > 1;
    if (second ||
        (binding.type == EnvironmentType::counters && binding.bytes % sizeof(uint32_t) != 0))
      return {ErrorKind::argument, VK_SUCCESS,
              fmt::format(
                  "environment binding {}: counters need a size that is a multiple of 4 bytes, and "
                  "only one binding can hold counters",
                  i)};
    if (binding.bytes == 0 || binding.bytes > maximum)
      return {ErrorKind::argument, VK_SUCCESS,
              fmt::format("environment binding {} has {} bytes; expected 1 to {}", i, binding.bytes,
                          maximum)};
    if (binding.contents.size() > binding.bytes)
      return {ErrorKind::argument, VK_SUCCESS,
              fmt::format("environment binding {} has {} bytes, but its contents have {}", i,
                          binding.bytes, binding.contents.size())};
  }
  return {};
}

// Returns the offset of each binding in the executor's own buffer for frame slot 0; 0 for tables,
// which have their own buffer.
std::vector<uint64_t> lay_out(State& state, std::span<const EnvironmentBinding> bindings) {
  const uint64_t alignment = table_alignment(*state.device);
  Environment& environment = state.environment;
  std::vector<uint64_t> offsets(bindings.size(), 0);
  uint64_t end = 0;
  for (size_t i = 0; i < bindings.size(); ++i) {
    if (bindings[i].type == EnvironmentType::linear_sampler || is_table(i, bindings[i])) continue;
    offsets[i] = end;
    const uint64_t stride = align_up(bindings[i].bytes, alignment);
    if (bindings[i].type == EnvironmentType::counters) {
      environment.counters_bytes = bindings[i].bytes;
      environment.counters_offset = end;
      environment.counters_stride = stride;
    } else {
      environment.constants_bytes = bindings[i].bytes;
      environment.constants_stride = stride;
    }
    end += stride * state.frames_in_flight;
  }
  environment.total_bytes = end;
  return offsets;
}

Error create_sampler(State& state) {
  const Device& device = *state.device;
  VkSamplerCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO;
  info.magFilter = info.minFilter = VK_FILTER_LINEAR;
  info.mipmapMode = VK_SAMPLER_MIPMAP_MODE_LINEAR;
  info.addressModeU = info.addressModeV = info.addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
  info.maxLod = VK_LOD_CLAMP_NONE;
  const VkResult result =
      device.vk.vkCreateSampler(device.device, &info, device.allocator, &state.environment.sampler);
  if (result != VK_SUCCESS) state.environment.sampler = VK_NULL_HANDLE;
  return call_error(result, "vkCreateSampler", "environment");
}

Error create_sets(State& state, std::span<const EnvironmentBinding> bindings) {
  const Device& device = *state.device;
  Environment& environment = state.environment;
  if (Error error = create_environment_layout(device, bindings, environment.set_layout))
    return error;
  std::vector<VkDescriptorPoolSize> sizes;
  for (const EnvironmentBinding& binding : bindings)
    sizes.push_back({descriptor_type(binding.type), state.frames_in_flight});
  VkDescriptorPoolCreateInfo pool{};
  pool.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
  pool.maxSets = state.frames_in_flight;
  pool.poolSizeCount = static_cast<uint32_t>(sizes.size());
  pool.pPoolSizes = sizes.data();
  VkResult result =
      device.vk.vkCreateDescriptorPool(device.device, &pool, device.allocator, &environment.pool);
  if (result != VK_SUCCESS) {
    environment.pool = VK_NULL_HANDLE;
    return call_error(result, "vkCreateDescriptorPool", "environment");
  }
  const std::vector<VkDescriptorSetLayout> layouts(state.frames_in_flight, environment.set_layout);
  environment.sets.assign(state.frames_in_flight, VK_NULL_HANDLE);
  VkDescriptorSetAllocateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO;
  info.descriptorPool = environment.pool;
  info.descriptorSetCount = state.frames_in_flight;
  info.pSetLayouts = layouts.data();
  result = device.vk.vkAllocateDescriptorSets(device.device, &info, environment.sets.data());
  return call_error(result, "vkAllocateDescriptorSets", "environment");
}

void write_sets(State& state, std::span<const EnvironmentBinding> bindings,
                const std::vector<uint64_t>& offsets) {
  const Device& device = *state.device;
  const Environment& environment = state.environment;
  for (uint32_t slot = 0; slot < state.frames_in_flight; ++slot)
    for (uint32_t i = 0; i < bindings.size(); ++i) {
      if (is_table(i, bindings[i])) continue;
      const bool counters = bindings[i].type == EnvironmentType::counters;
      const uint64_t stride = counters ? environment.counters_stride : environment.constants_stride;
      const VkDescriptorBufferInfo buffer{environment.buffer, offsets[i] + slot * stride,
                                          bindings[i].bytes};
      const VkDescriptorImageInfo sampler{environment.sampler, VK_NULL_HANDLE,
                                          VK_IMAGE_LAYOUT_UNDEFINED};
      VkWriteDescriptorSet write{};
      write.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
      write.dstSet = environment.sets[slot];
      write.dstBinding = i;
      write.descriptorCount = 1;
      write.descriptorType = descriptor_type(bindings[i].type);
      write.pBufferInfo = &buffer;
      write.pImageInfo = &sampler;
      device.vk.vkUpdateDescriptorSets(device.device, 1, &write, 0, nullptr);
    }
}

} // namespace

uint64_t table_alignment(const Device& device) {
  const VkPhysicalDeviceLimits& limits = device.properties.limits;
  return std::max<uint64_t>(
      {limits.minUniformBufferOffsetAlignment, limits.minStorageBufferOffsetAlignment, 16});
}

Error create_environment_layout(const Device& device, std::span<const EnvironmentBinding> bindings,
                                VkDescriptorSetLayout& layout) {
  std::vector<VkDescriptorSetLayoutBinding> slots;
  for (uint32_t i = 0; i < bindings.size(); ++i)
    slots.push_back(
        {i, descriptor_type(bindings[i].type), 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr});
  VkDescriptorSetLayoutCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO;
  info.bindingCount = static_cast<uint32_t>(slots.size());
  info.pBindings = slots.data();
  const VkResult result =
      device.vk.vkCreateDescriptorSetLayout(device.device, &info, device.allocator, &layout);
  if (result != VK_SUCCESS) layout = VK_NULL_HANDLE;
  return call_error(result, "vkCreateDescriptorSetLayout", "environment");
}

Error create_environment_buffer(const Device& device, const EnvironmentBuffer& description,
                                VkBuffer& buffer, MemoryBlock& memory) {
  const char* const name = description.name;
  const VkBufferCreateInfo info = buffer_create_info({description.bytes, description.usage});
  VkResult result = device.vk.vkCreateBuffer(device.device, &info, device.allocator, &buffer);
  if (result != VK_SUCCESS) {
    buffer = VK_NULL_HANDLE;
    return call_error(result, "vkCreateBuffer", name);
  }
  name_object(device, VK_OBJECT_TYPE_BUFFER, reinterpret_cast<uint64_t>(buffer), name);
  VkMemoryRequirements needs{};
  device.vk.vkGetBufferMemoryRequirements(device.device, buffer, &needs);
  const MemoryRequest request{
      MemoryPurpose::constants, needs.memoryTypeBits, needs.size,
      needs.alignment,          description.required, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT};
  if (Error error = allocate_memory(device, request, name, memory)) return error;
  const VkBindBufferMemoryInfo bind{VK_STRUCTURE_TYPE_BIND_BUFFER_MEMORY_INFO, nullptr, buffer,
                                    memory.memory, memory.offset};
  result = device.vk.vkBindBufferMemory2(device.device, 1, &bind);
  if (result != VK_SUCCESS) return call_error(result, "vkBindBufferMemory2", name);
  if ((description.required & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT) != 0)
    std::memset(memory.mapped, 0, description.bytes);
  return {};
}

Error create_environment(State& state, std::span<const EnvironmentBinding> bindings,
                         const std::shared_ptr<ViewTables>& tables) {
  if (bindings.empty()) return {};
  if (Error error = check_bindings(*state.device, bindings)) return error;
  const std::vector<uint64_t> offsets = lay_out(state, bindings);
  Environment& environment = state.environment;
  if (environment.total_bytes > 0) {
    if (Error error =
            create_environment_buffer(*state.device, {"environment", environment.total_bytes},
                                      environment.buffer, environment.memory))
      return error;
    environment.mapped = static_cast<std::byte*>(environment.memory.mapped);
  }
  if (Error error = create_sampler(state)) return error;
  if (Error error = create_sets(state, bindings)) return error;
  write_sets(state, bindings, offsets);
  environment.tables = tables;
  if (environment.tables == nullptr) {
    std::shared_ptr<const EnvironmentTables> source;
    if (Error error = EnvironmentTables::create(*state.device, bindings, source)) return error;
    if (Error error = ViewTables::create(std::move(source), environment.tables)) return error;
  }
  environment.tables_of_slot.resize(state.frames_in_flight);
  for (uint32_t slot = 0; slot < state.frames_in_flight; ++slot)
    refresh_tables(state, slot);
  return {};
}

void destroy_environment(State& state) {
  const Device& device = *state.device;
  const Environment& environment = state.environment;
  device.vk.vkDestroyDescriptorPool(device.device, environment.pool, device.allocator);
  device.vk.vkDestroyDescriptorSetLayout(device.device, environment.set_layout, device.allocator);
  device.vk.vkDestroySampler(device.device, environment.sampler, device.allocator);
  device.vk.vkDestroyBuffer(device.device, environment.buffer, device.allocator);
  free_memory(device, environment.memory);
}

void clear_counters(State& state, uint32_t frame_slot) noexcept {
  const Environment& environment = state.environment;
  if (environment.counters_bytes > 0)
    std::memset(environment.mapped + environment.counters_offset +
                    frame_slot * environment.counters_stride,
                0, environment.counters_bytes);
}

bool Executor::read_counters(uint64_t frame_index, std::span<uint32_t> counters) const noexcept {
  const State& state = *state_;
  const Environment& environment = state.environment;
  const auto frame_slot = static_cast<uint32_t>(frame_index % state.frames_in_flight);
  if (environment.counters_bytes == 0 || frame_index == 0 ||
      state.frame_of_slot[frame_slot] != frame_index)
    return false;
  std::memcpy(counters.data(),
              environment.mapped + environment.counters_offset +
                  frame_slot * environment.counters_stride,
              std::min<uint64_t>(counters.size_bytes(), environment.counters_bytes));
  return true;
}

void write_frame_constants(State& state, uint32_t frame_slot,
                           std::span<const std::byte> constants) noexcept {
  const Environment& environment = state.environment;
  if (!constants.empty())
    std::memcpy(environment.mapped + frame_slot * environment.constants_stride, constants.data(),
                constants.size());
}

} // namespace dermis::vulkan
