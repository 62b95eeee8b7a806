// Manages the static part of descriptor set 1, which may be replaced while frames run.
#include "framegraph/model/align_up.hpp"
#include "framegraph/vulkan/create_infos.hpp"
#include "framegraph/vulkan/executor/state.hpp"
#include "framegraph/vulkan/shader/signature_check.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

namespace dermis::vulkan {
namespace {

// Usage of the buffer with the tables, which kernels read or copies are made from.
constexpr VkBufferUsageFlags source_usage = VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT |
                                            VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
                                            VK_BUFFER_USAGE_TRANSFER_SRC_BIT;
constexpr VkBufferUsageFlags copy_usage = VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT |
                                          VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
                                          VK_BUFFER_USAGE_TRANSFER_DST_BIT;

// Returns whether the host can write the tables to device-local memory.
bool can_write_device_memory(const Device& device, uint64_t bytes) {
  const VkBufferCreateInfo info = buffer_create_info({bytes, source_usage});
  VkDeviceBufferMemoryRequirements query{};
  query.sType = VK_STRUCTURE_TYPE_DEVICE_BUFFER_MEMORY_REQUIREMENTS;
  query.pCreateInfo = &info;
  VkMemoryRequirements2 needs{};
  needs.sType = VK_STRUCTURE_TYPE_MEMORY_REQUIREMENTS_2;
  device.vk.vkGetDeviceBufferMemoryRequirements(device.device, &query, &needs);
  return has_memory_type(device, needs.memoryRequirements.memoryTypeBits,
                         host_memory_properties | VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
}

// Returns whether the host also sees memory that is not device-local.
bool has_other_host_memory(const Device& device) {
  const VkMemoryType* const types = device.memory.memoryTypes;
  return std::any_of(types, types + device.memory.memoryTypeCount, [](const VkMemoryType& type) {
    return (type.propertyFlags & host_memory_properties) == host_memory_properties &&
           (type.propertyFlags & VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT) == 0;
  });
}

} // namespace

bool is_table(size_t binding, const EnvironmentBinding& given) {
  if (given.type == EnvironmentType::uniform_buffer) return binding > 0; // 0: the frame constants
  return given.type == EnvironmentType::storage_buffer;
}

EnvironmentTables::State::~State() {
  device.vk.vkDestroyBuffer(device.device, buffer, device.allocator);
  free_memory(device, memory);
}

EnvironmentTables::EnvironmentTables(std::unique_ptr<State> state) : state_(std::move(state)) {}
EnvironmentTables::~EnvironmentTables() = default;

uint64_t EnvironmentTables::bytes() const noexcept {
  return state_->bytes;
}

Error EnvironmentTables::create(const Device& device,
                                std::span<const EnvironmentBinding> environment,
                                std::shared_ptr<const EnvironmentTables>& tables) {
  auto state = std::make_unique<State>(device);
  const uint64_t alignment = table_alignment(device);
  for (uint32_t i = 0; i < environment.size(); ++i) {
    if (!is_table(i, environment[i])) continue;
    const uint64_t bytes = environment[i].bytes;
    state->bindings.push_back({i, descriptor_type(environment[i].type), state->bytes, bytes});
    state->bytes += align_up(bytes, alignment);
  }
  if (state->bytes > 0) {
    state->device_local = can_write_device_memory(device, state->bytes);
    const EnvironmentBuffer tables_buffer{"environment tables", state->bytes, source_usage};
    if (state->device_local) {
      EnvironmentBuffer local = tables_buffer;
      local.required |= VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
      const Error error = create_environment_buffer(device, local, state->buffer, state->memory);
      // Memory that is both local and visible may be small; views then copy the tables.
      const bool may_retry = error.kind == ErrorKind::device_memory &&
                             device.host_memory.allocate == nullptr &&
                             has_other_host_memory(device);
      if (error && !may_retry) return error;
      state->device_local = !error;
    }
    if (!state->device_local) {
      device.vk.vkDestroyBuffer(device.device, state->buffer, device.allocator);
      free_memory(device, std::exchange(state->memory, {}));
      if (Error error =
              create_environment_buffer(device, tables_buffer, state->buffer, state->memory))
        return error;
    }
    auto* const to = static_cast<std::byte*>(state->memory.mapped);
    for (const TableBinding& table : state->bindings)
      if (const auto& contents = environment[table.binding].contents; !contents.empty())
        std::memcpy(to + table.offset, contents.data(), contents.size());
  }
  tables = std::shared_ptr<const EnvironmentTables>(new EnvironmentTables(std::move(state)));
  return {};
}

ViewTables::State::~State() {
  const Device& device = source->state().device;
  device.vk.vkDestroyBuffer(device.device, copy, device.allocator);
  free_memory(device, memory);
}

ViewTables::ViewTables(std::unique_ptr<State> state) : state_(std::move(state)) {}
ViewTables::~ViewTables() = default;

uint64_t ViewTables::bytes() const noexcept {
  return state_->copy != VK_NULL_HANDLE ? state_->source->bytes() : 0;
}

Error ViewTables::create(std::shared_ptr<const EnvironmentTables> source,
                         std::shared_ptr<ViewTables>& tables) {
  auto state = std::make_unique<State>(std::move(source));
  const EnvironmentTables::State& from = state->source->state();
  if (from.bytes > 0 && !from.device_local)
    if (Error error = create_environment_buffer(from.device,
                                                {"environment tables, copy", from.bytes, copy_usage,
                                                 VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT},
                                                state->copy, state->memory))
      return error;
  tables = std::shared_ptr<ViewTables>(new ViewTables(std::move(state)));
  return {};
}

void record_table_copy(State& state, VkCommandBuffer commands) noexcept {
  if (state.environment.tables == nullptr) return;
  ViewTables::State& tables = state.environment.tables->state();
  if (tables.copy == VK_NULL_HANDLE || tables.is_copied) return;
  const FunctionTable& vk = *state.commands;
  const EnvironmentTables::State& source = tables.source->state();
  const VkBufferCopy all{0, 0, source.bytes};
  vk.vkCmdCopyBuffer(commands, source.buffer, tables.copy, 1, &all);
  const VkMemoryBarrier2 copied{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                nullptr,
                                VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
                                VK_ACCESS_2_TRANSFER_WRITE_BIT,
                                VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                                VK_ACCESS_2_UNIFORM_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_READ_BIT};
  VkDependencyInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO;
  info.memoryBarrierCount = 1;
  info.pMemoryBarriers = &copied;
  vk.vkCmdPipelineBarrier2(commands, &info);
  tables.is_copied = true;
  state.snapshot.copied_tables = state.environment.tables;
}

void refresh_tables(State& state, uint32_t frame_slot) noexcept {
  Environment& environment = state.environment;
  if (environment.tables_of_slot.empty() ||
      environment.tables_of_slot[frame_slot] == environment.tables)
    return;
  const ViewTables::State& tables = environment.tables->state();
  const EnvironmentTables::State& source = tables.source->state();
  const VkBuffer read = tables.copy != VK_NULL_HANDLE ? tables.copy : source.buffer;
  for (const TableBinding& table : source.bindings) {
    const VkDescriptorBufferInfo buffer{read, table.offset, table.bytes};
    VkWriteDescriptorSet write{};
    write.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
    write.dstSet = environment.sets[frame_slot];
    write.dstBinding = table.binding;
    write.descriptorCount = 1;
    write.descriptorType = table.type;
    write.pBufferInfo = &buffer;
    state.device->vk.vkUpdateDescriptorSets(state.device->device, 1, &write, 0, nullptr);
  }
  environment.tables_of_slot[frame_slot] = environment.tables;
}

void Executor::set_tables(const std::shared_ptr<ViewTables>& tables) noexcept {
  state_->environment.tables = tables;
  release_tables(0); // updates slots in which no frame was recorded
}

void Executor::release_tables(uint64_t completed_frame_index) noexcept {
  for (uint32_t slot = 0; slot < state_->frames_in_flight; ++slot)
    if (state_->frame_of_slot[slot] <= completed_frame_index) refresh_tables(*state_, slot);
}

} // namespace dermis::vulkan
