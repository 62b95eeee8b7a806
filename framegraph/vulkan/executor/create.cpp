// Creates and destroys an Executor.
#include "framegraph/compile/written_size.hpp"
#include "framegraph/vulkan/executor/state.hpp"

#include <algorithm>
#include <fmt/core.h>

namespace dermis::vulkan {
namespace {

Error argument(std::string text) {
  return {ErrorKind::argument, VK_SUCCESS, std::move(text)};
}

Error check_input(const ExecutorInput& input) {
  if (input.device == nullptr || input.graph == nullptr || input.pass_types == nullptr ||
      input.plan == nullptr)
    return argument("device, graph, pass types and plan are required");
  if (input.frames_in_flight < 1 || input.frames_in_flight > max_frames_in_flight)
    return argument(fmt::format("{} frames in flight; expected 1 to {}", input.frames_in_flight,
                                max_frames_in_flight));
  for (const PlanPass& pass : input.plan->passes)
    if (pass.queue != Queue::main)
      return {ErrorKind::unsupported, VK_SUCCESS,
              fmt::format("pass '{}' runs on a second queue; compile the plan for a single queue",
                          input.graph->passes[pass.declared.value].name)};
  const auto fillable = [](const PlanResource& resource) { // the bit has the same value for buffers
    return resource.first_instance == no_instance ||
           (resource.vk_usage & VK_IMAGE_USAGE_TRANSFER_DST_BIT) != 0;
  };
  if (input.poison &&
      !std::all_of(input.plan->resources.begin(), input.plan->resources.end(), fillable))
    return argument("poison is requested, but the plan was compiled without it");
  return {};
}

uint32_t history_of(const Plan& plan, uint32_t resource) {
  for (uint32_t h = 0; h < plan.histories.size(); ++h)
    if (plan.histories[h].resource == resource) return h;
  return no_index;
}

void bind_port(const Plan& plan, Pass& pass, uint32_t index) {
  const PlanAccess& access = plan.accesses[index];
  PortAccess& port = pass.ports[access.port];
  switch (access.when) {
  case ReadWhen::always:
    port.access = index;
    break;
  case ReadWhen::history_valid:
    port.access = index;
    port.history = history_of(plan, access.resource);
    break;
  case ReadWhen::history_invalid:
    port.otherwise = index;
    break;
  }
}

void make_passes(State& state, const ExecutorInput& input) {
  state.passes.resize(state.plan.passes.size());
  for (size_t p = 0; p < state.passes.size(); ++p) {
    const PlanPass& planned = state.plan.passes[p];
    const PassType& type = (*input.pass_types)[planned.type];
    Pass& pass = state.passes[p];
    pass.name = input.graph->passes[planned.declared.value].name;
    if (type.dispatch.domain == DispatchRule::Domain::host) pass.host = planned.type;
    const TexelSize written = first_written_size(state.plan, planned, type);
    pass.written_groups = group_count(type.dispatch, written.width, written.height);
    pass.ports.resize(type.ports.size());
    for (uint32_t a = planned.first_access; a < planned.first_access + planned.access_count; ++a)
      bind_port(state.plan, pass, a);
    const PortMasks masks = port_masks(state.plan, planned);
    pass.port_mask = masks.bound;
    for (uint32_t port = 0; port < type.ports.size(); ++port)
      if ((masks.changing >> port & 1u) != 0) pass.conditional_ports.push_back(port);
  }
}

KernelInput kernel_input(const State& state, const ExecutorInput& input) {
  return {.device = *state.device,
          .pass_types = *input.pass_types,
          .codes = input.kernels,
          .environment = input.environment,
          .environment_layout = state.environment.set_layout,
          .cache = input.pipeline_cache,
          .store = input.kernel_store,
          .settings = input.settings};
}

Error add_kernels(State& state, const ExecutorInput& input) {
  PlanKernels made;
  const KernelInput kernels = kernel_input(state, input);
  if (Error error = create_kernels(kernels, state.plan, made)) return error;
  auto pipelines = std::make_shared<PlanPipelines>();
  if (Error error = create_pipelines(kernels, state.plan, made, *pipelines)) return error;
  state.pipelines = std::move(pipelines);
  state.pipelines_of_slot.assign(state.frames_in_flight, state.pipelines);
  state.kernels = std::move(made.kernels);
  for (size_t p = 0; p < state.passes.size(); ++p)
    state.passes[p].kernel = made.of_pass[p];
  return {};
}

// Checks before the first frame that clear passes only clear colour and buffers, and that indirect
// dispatches have arguments.
Error check_passes(State& state, const PassTypeRegistry& pass_types) {
  for (size_t p = 0; p < state.passes.size(); ++p) {
    const PlanPass& planned = state.plan.passes[p];
    Pass& pass = state.passes[p];
    const PassType& type = pass_types[planned.type];
    constexpr size_t mask_bits = 32;
    if (type.ports.size() > mask_bits)
      return argument(fmt::format("pass type '{}' has {} ports; the port mask supports at most {}",
                                  type.name, type.ports.size(), mask_bits));
    if (pass.kernel != no_index) {
      const Kernel& kernel = *state.kernels[pass.kernel];
      if (kernel.dispatch.domain == DispatchRule::Domain::indirect &&
          pass.ports[kernel.indirect_port].access == no_index)
        return argument(
            fmt::format("pass '{}' dispatches indirectly, but its port '{}' is not bound",
                        pass.name, type.ports[kernel.indirect_port].name));
      if (kernel.dispatch.domain == DispatchRule::Domain::indirect) {
        const PlanAccess& access = state.plan.accesses[pass.ports[kernel.indirect_port].access];
        pass.indirect_entries = state.plan.resources[access.resource].bytes / indirect_entry_bytes;
        if (pass.indirect_entries == 0)
          return argument(
              fmt::format("the indirect arguments of pass '{}' have fewer than {} bytes", pass.name,
                          indirect_entry_bytes));
      }
      continue;
    }
    if (pass.host.valid()) continue;
    for (uint32_t a = planned.first_access; a < planned.first_access + planned.access_count; ++a) {
      const PlanResource& resource = state.plan.resources[state.plan.accesses[a].resource];
      if (resource.type == ResourceType::image && format_info(resource.format).depth)
        return argument(fmt::format(
            "pass '{}' clears an image with a depth format; only colour formats can be cleared",
            pass.name));
    }
  }
  return {};
}

void make_slots(State& state) {
  for (uint32_t r = 0; r < state.plan.resources.size(); ++r) {
    const PlanResource& resource = state.plan.resources[r];
    if (resource.slot < 0) continue;
    const auto slot = static_cast<size_t>(resource.slot);
    if (state.slot_resource.size() <= slot) state.slot_resource.resize(slot + 1, no_index);
    if (resource.first_instance == no_instance) state.slot_resource[slot] = r;
  }
}

void make_histories(State& state, const ExecutorInput& input) {
  for (const PlanHistory& history : state.plan.histories) {
    HistoryRecord& record = state.histories.emplace_back();
    const ResourceDeclaration& declared =
        input.graph->resources[state.plan.resources[history.resource].declared.value];
    record.name = declared.name;
    invalidate_history(record, input.history == HistoryReason::valid ? HistoryReason::first_frame
                                                                     : input.history);
    // Contents that padding surrounds do not scale as the image does.
    record.scales =
        declared.size.align == 1 && declared.size.border == 0 &&
        can_rescale(*state.device, state.plan.resources[history.resource], history.declaration);
    for (const PlanPass& planned : state.plan.passes)
      for (uint32_t a = planned.first_access; a < planned.first_access + planned.access_count;
           ++a) {
        const PlanAccess& access = state.plan.accesses[a];
        if (access.resource == history.resource && access.frames_back == 0 &&
            (access.access & all_write_access) != 0)
          record.written = true;
      }
  }
}

// Allocates everything that recording needs, so that recording never allocates.
void reserve_for_recording(State& state) {
  size_t largest = std::max<size_t>(state.plan.final_barrier_count, state.slot_resource.size());
  size_t max_settings = 0;
  for (size_t p = 0; p < state.passes.size(); ++p)
    largest = std::max(largest, state.plan.passes[p].barrier_count +
                                    state.passes[p].writable_placeholders.size());
  for (const auto& kernel : state.kernels)
    max_settings = std::max<size_t>(max_settings, kernel->push_bytes / sizeof(uint32_t));
  reserve_clear_targets(state);
  largest = std::max(largest, state.clear_targets.capacity());
  state.image_barriers.resize(largest);
  state.buffer_barriers.resize(largest);
  state.memory_barriers.resize(largest + 2); // plus those of aliased memory and counters
  state.push_constants.resize(max_settings);
  state.chosen_pipelines.resize(state.passes.size());
  state.chosen_settings.reserve(state.plan.setting_values.size());
  for (FrameSnapshot* one : {&state.snapshot, &state.earlier_snapshot}) {
    one->histories.resize(state.histories.size());
    one->ready.resize(state.instances.size());
  }
}

} // namespace

Executor::State::~State() {
  if (device == nullptr) return;
  destroy_descriptors(*this);
  destroy_environment(*this);
  destroy_placeholders(*this);
  destroy_rescaling(*this);
  destroy_memory(*this);
  device->vk.vkDestroyQueryPool(device->device, timestamps.pool, device->allocator);
}

Error Executor::create(const ExecutorInput& input, std::unique_ptr<Executor>& executor) {
  if (Error error = check_input(input)) return error;
  auto state = std::make_unique<State>(
      input.kept_plan != nullptr ? input.kept_plan : std::make_shared<const Plan>(*input.plan));
  state->device = input.device;
  state->frames_in_flight = input.frames_in_flight;
  state->poison = input.poison;
  state->heap_pool = input.heap_pool;
  state->frame_of_slot.assign(input.frames_in_flight, 0);
  make_passes(*state, input);
  make_slots(*state);
  make_histories(*state, input);
  if (Error error = create_environment(*state, input.environment, input.tables)) return error;
  if (Error error = add_kernels(*state, input)) return error;
  if (Error error = check_passes(*state, *input.pass_types)) return error;
  if (Error error = check_host_passes(*state, input)) return error;
  if (Error error = create_memory(*state, *input.graph)) return error;
  if (Error error = create_rescaling(*state, input)) return error;
  if (Error error = create_descriptors(*state, *input.pass_types)) return error;
  if (Error error = create_placeholders(*state)) return error;
  if (Error error = create_timestamps(*state)) return error;
  reserve_for_recording(*state);
  executor.reset(new Executor(std::move(state)));
  return {};
}

Error Executor::make_pipelines(const ExecutorInput& input,
                               std::shared_ptr<const PlanPipelines>& pipelines) const {
  const State& state = *state_;
  PlanKernels kernels{.kernels = state.kernels, .of_pass = {}};
  for (const Pass& pass : state.passes)
    kernels.of_pass.push_back(pass.kernel);
  auto made = std::make_shared<PlanPipelines>();
  if (Error error = create_pipelines(kernel_input(state, input), state.plan, kernels, *made))
    return error;
  pipelines = std::move(made);
  return {};
}

void Executor::set_pipelines(const std::shared_ptr<const PlanPipelines>& pipelines) noexcept {
  state_->pipelines = pipelines;
  state_->chosen = false;
  release_pipelines(0); // updates slots in which no frame was recorded
}

void Executor::release_pipelines(uint64_t completed_frame_index) noexcept {
  for (uint32_t slot = 0; slot < state_->frames_in_flight; ++slot)
    if (state_->frame_of_slot[slot] <= completed_frame_index)
      state_->pipelines_of_slot[slot] = state_->pipelines;
}

Executor::Executor(std::unique_ptr<State> state) : state_(std::move(state)) {}
Executor::~Executor() = default;

const Plan& Executor::plan() const noexcept {
  return state_->plan;
}

MemoryRequest Executor::heap_request(uint32_t index) const noexcept {
  return index < state_->heaps.size() && state_->heaps[index].owned ? state_->heaps[index].request
                                                                    : MemoryRequest{};
}

bool Executor::saw_lost_device() const noexcept {
  return state_->saw_lost_device;
}

uint64_t Executor::constant_bytes() const noexcept {
  return state_->environment.total_bytes;
}

} // namespace dermis::vulkan
