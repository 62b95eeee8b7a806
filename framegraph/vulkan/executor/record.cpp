// Records one frame of the plan into the host's command buffer.
#include "framegraph/vulkan/create_infos.hpp"
#include "framegraph/vulkan/executor/state.hpp"

#include <algorithm>

namespace dermis::vulkan {
namespace {

RecordResult reject(const char* text, int32_t slot = -1) {
  return {ErrorKind::argument, VK_SUCCESS, text, slot};
}

RecordResult check_buffer(const State& state, const FrameInput& frame,
                          const PlanResource& resource) {
  const auto slot = static_cast<size_t>(resource.slot);
  if (slot >= frame.buffers.size() || frame.buffers[slot].buffer == VK_NULL_HANDLE)
    return reject("the slot is not bound", resource.slot);
  const HostBuffer& bound = frame.buffers[slot];
  const VkPhysicalDeviceLimits& limits = state.device->properties.limits;
  if (bound.bytes < resource.bytes || bound.bytes > limits.maxStorageBufferRange)
    return reject(
        "the buffer has fewer bytes than the graph needs, or more than the device can bind",
        resource.slot);
  if (bound.offset % std::max<VkDeviceSize>(limits.minStorageBufferOffsetAlignment, 1) != 0)
    return reject("the buffer's offset is not a multiple of minStorageBufferOffsetAlignment",
                  resource.slot);
  constexpr VkDeviceSize indirect_alignment = 4;
  if ((resource.vk_usage & VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT) != 0 &&
      bound.offset % indirect_alignment != 0)
    return reject(
        "the buffer's offset is not a multiple of 4, which indirect dispatch arguments require",
        resource.slot);
  return {};
}

RecordResult check_slots(const State& state, const FrameInput& frame) {
  for (size_t slot = 0; slot < state.slot_resource.size(); ++slot) {
    if (state.slot_resource[slot] == no_index) continue;
    const auto number = static_cast<int32_t>(slot);
    const PlanResource& resource = state.plan.resources[state.slot_resource[slot]];
    if (resource.type == ResourceType::buffer) {
      if (const RecordResult rejected = check_buffer(state, frame, resource)) return rejected;
      continue;
    }
    if (resource.type == ResourceType::acceleration_structure) {
      if (slot >= frame.structures.size() || frame.structures[slot].structure == VK_NULL_HANDLE)
        return reject("the slot is not bound", number);
      continue;
    }
    if (slot >= frame.images.size() || frame.images[slot].image == VK_NULL_HANDLE)
      return reject("the slot is not bound", number);
    if (frame.images[slot].view == VK_NULL_HANDLE && (resource.vk_usage & viewable_usage) != 0)
      return reject("the binding has no view", number);
    const VkImageLayout after = frame.images[slot].after.layout;
    if (after == VK_IMAGE_LAYOUT_UNDEFINED || after == VK_IMAGE_LAYOUT_PREINITIALIZED)
      return reject("after.layout must be a layout to which an image can be transitioned", number);
  }
  return {};
}

RecordResult check_frame(const State& state, const FrameInput& frame, const Rectangle& rectangle) {
  if (frame.command_buffer == VK_NULL_HANDLE) return reject("the command buffer is null");
  if (frame.frame_index <= state.last_frame_index)
    return reject("frame_index must increase from frame to frame");
  const uint64_t right = uint64_t{rectangle.x} + rectangle.width,
                 bottom = uint64_t{rectangle.y} + rectangle.height;
  if (rectangle.width == 0 || rectangle.height == 0 || right > state.plan.view_width ||
      bottom > state.plan.view_height)
    return reject("the render rectangle is empty or not inside the allocated size");
  if (frame.frame_constants.size() > state.environment.constants_bytes)
    return reject("frame_constants has more bytes than environment binding 0");
  if (!frame.settings.empty() && frame.settings.size() < state.plan.setting_values.size())
    return reject("settings has fewer values than the graph has settings");
  return check_slots(state, frame);
}

// Returns whether the pipeline has the constants that the pass has in this frame. Masks of ports
// are equal in all pipelines of a pass.
bool is_for_frame(const State& state, const FrameInput& frame, const PlanPass& planned,
                  const Pipeline& pipeline) {
  for (size_t i = 0; i < pipeline.constants.size(); ++i)
    if (const uint32_t setting = pipeline.kernel->constants[i].setting;
        setting != no_index &&
        pipeline.constants[i] !=
            kernel_word(value_of(state.plan, planned, setting, frame.settings)))
      return false;
  return true;
}

// Returns the settings of the frame that a plan can follow; empty: the plan's values.
std::span<const SettingValue> followed_settings(const State& state, const FrameInput& frame) {
  return frame.settings.first(std::min(frame.settings.size(), state.plan.setting_values.size()));
}

// Chooses the pipelines of all passes. Most frames have the settings of the previous frame.
RecordResult choose_pipelines(State& state, const FrameInput& frame) {
  const auto is_same = [](const SettingValue& a, const SettingValue& b) {
    return a.integer == b.integer && a.real == b.real;
  };
  const std::span<const SettingValue> settings = followed_settings(state, frame);
  if (state.chosen && std::ranges::equal(settings, state.chosen_settings, is_same)) return {};
  state.chosen = false;
  for (size_t p = 0; p < state.passes.size(); ++p) {
    if (state.passes[p].kernel == no_index) continue;
    const Pipeline* chosen = nullptr;
    for (const uint32_t index : state.pipelines->of_pass[p]) {
      const Pipeline& pipeline = *state.pipelines->all[index];
      if (!is_for_frame(state, frame, state.plan.passes[p], pipeline)) continue;
      chosen = &pipeline;
      break;
    }
    if (chosen == nullptr)
      return reject("no pipelines were created for these values of the settings");
    state.chosen_pipelines[p] = chosen->handle;
  }
  state.chosen_settings.assign(settings.begin(), settings.end());
  state.chosen = true;
  return {};
}

void invalidate_for_cut(State& state) {
  for (size_t h = 0; h < state.histories.size(); ++h) {
    const PlanHistory& history = state.plan.histories[h];
    if (history.declaration.on_cut != HistoryDeclaration::OnCut::invalidate) continue;
    invalidate_history(state.histories[h], HistoryReason::cut);
    const PlanResource& resource = state.plan.resources[history.resource];
    for (uint32_t i = 0; i < resource.instance_count; ++i)
      state.instances[resource.first_instance + i].ready = false;
  }
  // The host may cut because it discarded a recorded frame, whose initialisation then never ran.
  state.placeholders_ready = false;
}

void push_settings(State& state, const FrameInput& frame, const PlanPass& planned, const Pass& pass,
                   const Kernel& kernel) {
  state.push_constants[0] = pass.port_mask;
  for (const uint32_t port : pass.conditional_ports)
    if (access_now(state, pass.ports[port]) != no_index)
      state.push_constants[0] |= uint32_t{1} << port;
  for (size_t i = 0; i < kernel.pushed_settings.size(); ++i)
    state.push_constants[1 + i] =
        kernel_word(value_of(state.plan, planned, kernel.pushed_settings[i], frame.settings));
  state.commands->vkCmdPushConstants(frame.command_buffer, kernel.layout,
                                     VK_SHADER_STAGE_COMPUTE_BIT, 0, kernel.push_bytes,
                                     state.push_constants.data());
}

// The buffer that holds the arguments of a dispatch, and the offset of its first entry, bytes.
struct IndirectArguments {
  VkBuffer buffer = VK_NULL_HANDLE;
  VkDeviceSize offset = 0;
};

IndirectArguments indirect_arguments(const State& state, const FrameInput& frame, const Pass& pass,
                                     const Kernel& kernel) {
  const PlanAccess& access = state.plan.accesses[pass.ports[kernel.indirect_port].access];
  const PlanResource& resource = state.plan.resources[access.resource];
  if (resource.first_instance == no_instance) {
    const HostBuffer& bound = frame.buffers[static_cast<size_t>(resource.slot)];
    return {bound.buffer, bound.offset};
  }
  return {state.instances[instance_of(state, resource, access.frames_back)].buffer, 0};
}

// Returns the byte offset of the pass's entry in the indirect arguments. An index beyond the end
// selects the last entry.
uint64_t indirect_offset(const State& state, const FrameInput& frame, const PlanPass& planned,
                         const Pass& pass, const Kernel& kernel) {
  if (kernel.entry_setting == no_index) return 0;
  const int64_t entry = value_of(state.plan, planned, kernel.entry_setting, frame.settings).integer;
  return indirect_entry_bytes *
         std::min(static_cast<uint64_t>(std::max(entry, int64_t{0})), pass.indirect_entries - 1);
}

void dispatch(State& state, const FrameInput& frame, const PlanPass& planned, const Pass& pass,
              const Kernel& kernel, const Rectangle& r) {
  const FunctionTable& vk = *state.commands;
  if (kernel.dispatch.domain == DispatchRule::Domain::indirect) {
    const IndirectArguments arguments = indirect_arguments(state, frame, pass, kernel);
    return vk.vkCmdDispatchIndirect(frame.command_buffer, arguments.buffer,
                                    arguments.offset +
                                        indirect_offset(state, frame, planned, pass, kernel));
  }
  const bool by_image = kernel.dispatch.domain == DispatchRule::Domain::written_image;
  const GroupCount groups =
      by_image ? pass.written_groups : group_count(kernel.dispatch, r.width, r.height);
  if (groups.total() > 0)
    vk.vkCmdDispatch(frame.command_buffer, static_cast<uint32_t>(groups.x),
                     static_cast<uint32_t>(groups.y), static_cast<uint32_t>(groups.z));
}

void run_kernel(State& state, const FrameInput& frame, uint32_t frame_slot, size_t p,
                const Rectangle& rectangle) {
  const FunctionTable& vk = *state.commands;
  const Pass& pass = state.passes[p];
  const Kernel& kernel = *state.kernels[pass.kernel];
  vk.vkCmdBindPipeline(frame.command_buffer, VK_PIPELINE_BIND_POINT_COMPUTE,
                       state.chosen_pipelines[p]);
  const bool environment = state.environment.set_layout != VK_NULL_HANDLE;
  const VkDescriptorSet sets[] = {state.descriptors.sets[set_index(state, p, frame_slot)],
                                  environment ? state.environment.sets[frame_slot]
                                              : VK_NULL_HANDLE};
  vk.vkCmdBindDescriptorSets(frame.command_buffer, VK_PIPELINE_BIND_POINT_COMPUTE, kernel.layout, 0,
                             environment ? 2 : 1, sets, 0, nullptr);
  push_settings(state, frame, state.plan.passes[p], pass, kernel);
  dispatch(state, frame, state.plan.passes[p], pass, kernel, rectangle);
}

void run_clear(State& state, const FrameInput& frame, size_t p) {
  const FunctionTable& vk = *state.commands;
  const PlanPass& planned = state.plan.passes[p];
  const VkClearColorValue zero{};
  for (uint32_t a = planned.first_access; a < planned.first_access + planned.access_count; ++a) {
    const PlanAccess& access = state.plan.accesses[a];
    const PlanResource& resource = state.plan.resources[access.resource];
    const bool host_owned = resource.first_instance == no_instance;
    const Instance none;
    const Instance& instance =
        host_owned ? none : state.instances[instance_of(state, resource, access.frames_back)];
    if (resource.type == ResourceType::buffer) {
      const HostBuffer own{instance.buffer, 0, VK_WHOLE_SIZE, {}, {}};
      const HostBuffer& to = host_owned ? frame.buffers[static_cast<size_t>(resource.slot)] : own;
      vk.vkCmdFillBuffer(frame.command_buffer, to.buffer, to.offset, to.bytes, 0);
      continue;
    }
    const HostImage* host =
        host_owned ? &frame.images[static_cast<size_t>(resource.slot)] : nullptr;
    const VkImage image = host_owned ? host->image : instance.image;
    VkImageSubresourceRange range{VK_IMAGE_ASPECT_COLOR_BIT, 0, VK_REMAINING_MIP_LEVELS, 0,
                                  VK_REMAINING_ARRAY_LAYERS};
    if (host_owned) range.baseArrayLayer = host->first_layer;
    if (host_owned && host->layers > 0) range.layerCount = host->layers;
    if (access.range != resource.whole())
      range = {VK_IMAGE_ASPECT_COLOR_BIT, access.range.first_mip, access.range.mips,
               access.range.first_layer, access.range.layers};
    vk.vkCmdClearColorImage(frame.command_buffer, image, static_cast<VkImageLayout>(access.layout),
                            &zero, 1, &range);
  }
}

bool is_left_out(const FrameInput& frame, size_t p) {
  return p < frame.left_out.size() && frame.left_out[p] != 0;
}

bool uses_counters(const State& state, size_t p) {
  const uint32_t kernel = state.passes[p].kernel;
  return kernel != no_index && state.kernels[kernel]->counts;
}

// Invalidates the histories that pass `p` writes, because the pass did not run.
void invalidate_written(State& state, size_t p) {
  const PlanPass& pass = state.plan.passes[p];
  for (uint32_t a = pass.first_access; a < pass.first_access + pass.access_count; ++a) {
    const PlanAccess& access = state.plan.accesses[a];
    if (access.frames_back != 0 || (access.access & all_write_access) == 0) continue;
    for (size_t h = 0; h < state.histories.size(); ++h) {
      if (state.plan.histories[h].resource != access.resource) continue;
      invalidate_history(state.histories[h], HistoryReason::left_out);
      const PlanResource& resource = state.plan.resources[access.resource];
      for (uint32_t i = 0; resource.first_instance != no_instance && i < resource.instance_count;
           ++i)
        state.instances[resource.first_instance + i].ready = false;
    }
  }
}

void run_pass(State& state, const FrameInput& frame, uint32_t frame_slot, size_t p,
              const Rectangle& rectangle) {
  if (state.passes[p].host.valid())
    run_host_pass(state, frame, p, rectangle);
  else if (state.passes[p].kernel == no_index)
    run_clear(state, frame, p);
  else
    run_kernel(state, frame, frame_slot, p, rectangle);
}

// A host that captures commands identifies passes by their labels, so they are recorded even
// without debug utils.
bool labelled(const State& state) {
  return state.device->labels || state.commands != &state.device->vk;
}

void begin_label(const State& state, VkCommandBuffer commands, const char* name) {
  if (!labelled(state)) return;
  const VkDebugUtilsLabelEXT label{
      VK_STRUCTURE_TYPE_DEBUG_UTILS_LABEL_EXT, nullptr, name, {0, 0, 0, 0}};
  state.commands->vkCmdBeginDebugUtilsLabelEXT(commands, &label);
}

void end_label(const State& state, VkCommandBuffer commands) {
  if (labelled(state)) state.commands->vkCmdEndDebugUtilsLabelEXT(commands);
}

void finish_frame(State& state, const FrameInput& frame, uint32_t frame_slot,
                  const Rectangle& rectangle) {
  for (size_t h = 0; h < state.histories.size(); ++h) {
    HistoryRecord& history = state.histories[h];
    const PlanResource& resource = state.plan.resources[state.plan.histories[h].resource];
    if (resource.first_instance != no_instance)
      state.instances[instance_of(state, resource, 0)].ready = history.written;
    history.age = history.written ? history.age + (history.age == UINT32_MAX ? 0 : 1) : 0;
    if (history.age > 0) history.reason = HistoryReason::valid;
  }
  if (state.timestamps.pool != VK_NULL_HANDLE)
    state.timestamps.frame_of_slot[frame_slot] = frame.frame_index;
  state.previous_rectangle = rectangle;
  state.last_frame_index = frame.frame_index;
  state.frame_of_slot[frame_slot] = frame.frame_index;
  ++state.frame_counter;
}

} // namespace

RecordResult Executor::record(const FrameInput& frame) noexcept {
  State& state = *state_;
  const Rectangle rectangle = frame.rectangle.width == 0
                                  ? Rectangle{0, 0, state.plan.view_width, state.plan.view_height}
                                  : frame.rectangle;
  if (const RecordResult rejected = check_frame(state, frame, rectangle)) return rejected;
  if (const RecordResult rejected = choose_pipelines(state, frame)) return rejected;
  state.commands = frame.commands == nullptr ? &state.device->vk : frame.commands;
  const VkCommandBuffer commands = frame.command_buffer;
  const auto frame_slot = static_cast<uint32_t>(frame.frame_index % state.frames_in_flight);
  state.pipelines_of_slot[frame_slot] = state.pipelines;
  save_snapshot(state);
  if (frame.reset_history) invalidate_for_cut(state);

  if (frame.memory_overwritten) invalidate_histories(state, HistoryReason::switched);
  if (frame.before != nullptr) carry_ages(state, *frame.before->state_, frame.reset_history);
  refresh_tables(state, frame_slot);
  write_frame_constants(state, frame_slot, frame.frame_constants);
  clear_counters(state, frame_slot);
  write_descriptors(state, frame_slot, frame);
  if (frame.memory_overwritten) record_memory_acquire(state, frame);
  record_table_copy(state, commands);
  if (frame.before != nullptr)
    record_carried(state, *frame.before->state_, commands, frame_slot, frame.reset_history);
  begin_timestamps(state, commands, frame_slot);
  record_acquires(state, frame);
  record_initialisation(state, commands);
  bool counted = false; // by an earlier pass of the frame
  for (size_t p = 0; p < state.passes.size(); ++p) {
    const PlanPass& planned = state.plan.passes[p];
    const bool counts = !is_left_out(frame, p) && uses_counters(state, p);
    begin_label(state, commands, state.passes[p].name.c_str());
    record_barriers(state, frame,
                    {planned.first_barrier, planned.barrier_count,
                     state.passes[p].writable_placeholders,
                     counts && counted ? CountersTo::kernel : CountersTo::nobody});
    if (!is_left_out(frame, p)) run_pass(state, frame, frame_slot, p, rectangle);
    counted = counted || counts;
    end_label(state, commands);
    write_timestamp(state, commands, frame_slot, static_cast<uint32_t>(p) + 1);
  }
  record_barriers(state, frame,
                  {state.plan.first_final_barrier,
                   state.plan.final_barrier_count,
                   {},
                   counted ? CountersTo::host : CountersTo::nobody});
  record_releases(state, frame);
  finish_frame(state, frame, frame_slot, rectangle);
  for (size_t p = 0; p < state.passes.size(); ++p)
    if (is_left_out(frame, p)) invalidate_written(state, p);
  return {};
}

} // namespace dermis::vulkan
