// Manages the static part of descriptor set 1, which may be replaced while frames run.
#include "framegraph/vulkan/executor/state.hpp"
#include "framegraph/vulkan/shader/signature_check.hpp"

#include <cstring>

namespace dermis::vulkan {

bool is_table(size_t binding, const EnvironmentBinding& given) {
  if (given.type == EnvironmentType::uniform_buffer) return binding > 0; // 0: the frame constants
  return given.type == EnvironmentType::storage_buffer;
}

EnvironmentTables::State::~State() {
  device.vk.vkDestroyBuffer(device.device, buffer, device.allocator);
  give_back_memory(device, memory);
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
    state->bytes += (bytes + alignment - 1) / alignment * alignment;
  }
  if (state->bytes > 0) {
    if (Error error = create_environment_buffer(device, state->bytes, "environment tables",
                                                state->buffer, state->memory))
      return error;
    auto* const to = static_cast<std::byte*>(state->memory.mapped);
    for (const TableBinding& table : state->bindings)
      if (const auto& contents = environment[table.binding].contents; !contents.empty())
        std::memcpy(to + table.offset, contents.data(), contents.size());
  }
  tables = std::shared_ptr<const EnvironmentTables>(new EnvironmentTables(std::move(state)));
  return {};
}

void refresh_tables(State& state, uint32_t frame_slot) noexcept {
  Environment& environment = state.environment;
  if (environment.tables_of_slot.empty() ||
      environment.tables_of_slot[frame_slot] == environment.tables)
    return;
  const EnvironmentTables::State& tables = environment.tables->state();
  for (const TableBinding& table : tables.bindings) {
    const VkDescriptorBufferInfo buffer{tables.buffer, table.offset, table.bytes};
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

void Executor::set_tables(const std::shared_ptr<const EnvironmentTables>& tables) noexcept {
  state_->environment.tables = tables;
  release_tables(0); // updates slots in which no frame was recorded
}

void Executor::release_tables(uint64_t completed_frame_index) noexcept {
  for (uint32_t slot = 0; slot < state_->frames_in_flight; ++slot)
    if (state_->frame_of_slot[slot] <= completed_frame_index) refresh_tables(*state_, slot);
}

} // namespace dermis::vulkan
