#include "integration/abi/commands/capture.hpp"

#include "integration/abi/host_pass_types.hpp"

namespace dermis::abi {
namespace {

Capture& capture_of(VkCommandBuffer commands) {
  return *reinterpret_cast<Capture*>(commands);
}

// Appends a command. If memory runs out, returns a scratch command that is not in the list.
dermis_command& add(Capture& capture, dermis_command_type type) noexcept {
  static thread_local dermis_command lost;
  dermis_command command = DERMIS_COMMAND_INIT;
  command.type = type;
  command.pass = capture.pass;
  try {
    return capture.commands.emplace_back(command);
  } catch (const std::bad_alloc&) {
    capture.failed = true;
    return lost = command;
  }
}

template <class T> const T* keep(Capture& capture, const T* items, uint32_t count) noexcept {
  const T* copy = capture.arena.copy(std::span<const T>(items, count));
  if (copy == nullptr && count > 0) capture.failed = true;
  return copy;
}

void VKAPI_CALL barrier(VkCommandBuffer commands, const VkDependencyInfo* info) {
  Capture& capture = capture_of(commands);
  VkDependencyInfo kept = *info;
  kept.pMemoryBarriers = keep(capture, info->pMemoryBarriers, info->memoryBarrierCount);
  kept.pBufferMemoryBarriers =
      keep(capture, info->pBufferMemoryBarriers, info->bufferMemoryBarrierCount);
  kept.pImageMemoryBarriers =
      keep(capture, info->pImageMemoryBarriers, info->imageMemoryBarrierCount);
  add(capture, DERMIS_COMMAND_BARRIER).dependency = keep(capture, &kept, 1);
}

void VKAPI_CALL bind_pipeline(VkCommandBuffer commands, VkPipelineBindPoint, VkPipeline pipeline) {
  capture_of(commands).pipeline = pipeline;
}

void VKAPI_CALL bind_sets(VkCommandBuffer commands, VkPipelineBindPoint, VkPipelineLayout layout,
                          uint32_t, uint32_t count, const VkDescriptorSet* sets, uint32_t,
                          const uint32_t*) {
  Capture& capture = capture_of(commands);
  capture.layout = layout;
  capture.sets = keep(capture, sets, count);
  capture.set_count = count;
}

void VKAPI_CALL push_constants(VkCommandBuffer commands, VkPipelineLayout, VkShaderStageFlags,
                               uint32_t, uint32_t bytes, const void* values) {
  Capture& capture = capture_of(commands);
  capture.push_constants = keep(capture, static_cast<const std::byte*>(values), bytes);
  capture.push_bytes = bytes;
}

dermis_command& add_dispatch(Capture& capture, dermis_command_type type) {
  dermis_command& command = add(capture, type);
  command.pipeline = capture.pipeline;
  command.layout = capture.layout;
  command.sets = capture.sets;
  command.set_count = capture.set_count;
  command.push_constants = capture.push_constants;
  command.push_bytes = capture.push_bytes;
  return command;
}

void VKAPI_CALL dispatch(VkCommandBuffer commands, uint32_t x, uint32_t y, uint32_t z) {
  dermis_command& command = add_dispatch(capture_of(commands), DERMIS_COMMAND_DISPATCH);
  command.groups[0] = x;
  command.groups[1] = y;
  command.groups[2] = z;
}

void VKAPI_CALL dispatch_indirect(VkCommandBuffer commands, VkBuffer buffer, VkDeviceSize offset) {
  dermis_command& command = add_dispatch(capture_of(commands), DERMIS_COMMAND_DISPATCH_INDIRECT);
  command.buffer = buffer;
  command.offset = offset;
}

void VKAPI_CALL fill_buffer(VkCommandBuffer commands, VkBuffer buffer, VkDeviceSize offset,
                            VkDeviceSize bytes, uint32_t value) {
  dermis_command& command = add(capture_of(commands), DERMIS_COMMAND_FILL_BUFFER);
  command.buffer = buffer;
  command.offset = offset;
  command.bytes = bytes;
  command.value = value;
}

void VKAPI_CALL clear_image(VkCommandBuffer commands, VkImage image, VkImageLayout layout,
                            const VkClearColorValue* color, uint32_t count,
                            const VkImageSubresourceRange* ranges) {
  Capture& capture = capture_of(commands);
  dermis_command& command = add(capture, DERMIS_COMMAND_CLEAR_IMAGE);
  command.image = image;
  command.image_layout = layout;
  command.color = *color;
  command.count = count;
  command.ranges = keep(capture, ranges, count);
}

void VKAPI_CALL copy_buffer(VkCommandBuffer commands, VkBuffer from, VkBuffer to, uint32_t count,
                            const VkBufferCopy* regions) {
  Capture& capture = capture_of(commands);
  dermis_command& command = add(capture, DERMIS_COMMAND_COPY_BUFFER);
  command.buffer = from;
  command.to_buffer = to;
  command.count = count;
  command.buffer_copies = keep(capture, regions, count);
}

dermis_command& add_transfer(Capture& capture, dermis_command_type type, VkImage from,
                             VkImageLayout from_layout, VkImage to, VkImageLayout to_layout,
                             uint32_t count) {
  dermis_command& command = add(capture, type);
  command.image = from;
  command.image_layout = from_layout;
  command.to_image = to;
  command.to_layout = to_layout;
  command.count = count;
  return command;
}

void VKAPI_CALL copy_image(VkCommandBuffer commands, VkImage from, VkImageLayout from_layout,
                           VkImage to, VkImageLayout to_layout, uint32_t count,
                           const VkImageCopy* regions) {
  Capture& capture = capture_of(commands);
  add_transfer(capture, DERMIS_COMMAND_COPY_IMAGE, from, from_layout, to, to_layout, count)
      .image_copies = keep(capture, regions, count);
}

void VKAPI_CALL reset_queries(VkCommandBuffer commands, VkQueryPool pool, uint32_t first,
                              uint32_t count) {
  dermis_command& command = add(capture_of(commands), DERMIS_COMMAND_RESET_QUERIES);
  command.query_pool = pool;
  command.query = first;
  command.count = count;
}

void VKAPI_CALL write_timestamp(VkCommandBuffer commands, VkPipelineStageFlags2 stages,
                                VkQueryPool pool, uint32_t query) {
  dermis_command& command = add(capture_of(commands), DERMIS_COMMAND_WRITE_TIMESTAMP);
  command.stages = stages;
  command.query_pool = pool;
  command.query = query;
}

void VKAPI_CALL begin_label(VkCommandBuffer commands, const VkDebugUtilsLabelEXT* label) {
  capture_of(commands).pass = label->pLabelName;
}

void VKAPI_CALL end_label(VkCommandBuffer commands) {
  capture_of(commands).pass = "";
}

constexpr vulkan::FunctionTable make_table() {
  vulkan::FunctionTable table;
  table.vkCmdPipelineBarrier2 = barrier;
  table.vkCmdBindPipeline = bind_pipeline;
  table.vkCmdBindDescriptorSets = bind_sets;
  table.vkCmdPushConstants = push_constants;
  table.vkCmdDispatch = dispatch;
  table.vkCmdDispatchIndirect = dispatch_indirect;
  table.vkCmdFillBuffer = fill_buffer;
  table.vkCmdClearColorImage = clear_image;
  table.vkCmdCopyBuffer = copy_buffer;
  table.vkCmdCopyImage = copy_image;
  table.vkCmdResetQueryPool = reset_queries;
  table.vkCmdWriteTimestamp2 = write_timestamp;
  table.vkCmdBeginDebugUtilsLabelEXT = begin_label;
  table.vkCmdEndDebugUtilsLabelEXT = end_label;
  return table;
}

constexpr vulkan::FunctionTable capture_table = make_table();

void capture_host_pass(void* list, const vulkan::HostPass& call) {
  Capture& capture = *static_cast<Capture*>(list);
  HostPassCall whole;
  fill_host_pass(call, whole);
  whole.call.command_buffer = VK_NULL_HANDLE; // the host records into its own command buffer
  whole.call.ports = keep(capture, whole.ports.data(), whole.call.port_count);
  whole.call.settings = keep(capture, whole.settings.data(), whole.call.setting_count);
  add(capture, DERMIS_COMMAND_HOST_PASS).call = keep(capture, &whole.call, 1);
}

} // namespace

void clear(Capture& capture) noexcept {
  capture.commands.clear();
  capture.arena.reset();
  capture.failed = false;
  capture.pass = "";
}

VkCommandBuffer handle_of(Capture& capture) noexcept {
  return reinterpret_cast<VkCommandBuffer>(&capture);
}

void capture_into(Capture& capture, vulkan::FrameInput& frame) noexcept {
  frame.command_buffer = handle_of(capture);
  frame.commands = &capture_table;
  frame.host_pass = capture_host_pass;
  frame.host_pass_user = &capture;
}

} // namespace dermis::abi
