#include "integration/tools/command/kernels/graph_counts.hpp"

#include "framegraph/vulkan/device_profile.hpp"
#include "passes/choice/configurations.hpp"

#include <cassert>

namespace dermis::tools {
namespace {

constexpr uint64_t steady_frame = 8; // histories of all shipped graphs are valid by then

struct HostBindings {
  std::vector<vulkan::HostImage> images;
  std::vector<vulkan::HostBuffer> buffers;
  std::vector<vulkan::HostStructure> structures;
};

// Binds every slot of the plan, in states that an engine has after its own passes.
HostBindings bind_all(NullDevice& device, const Plan& plan) {
  constexpr uint64_t enough = uint64_t{1} << 30; // bytes
  const vulkan::HostState written{VK_IMAGE_LAYOUT_GENERAL, VK_QUEUE_FAMILY_IGNORED,
                                  VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                                  VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT};
  const vulkan::HostState read{VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, VK_QUEUE_FAMILY_IGNORED,
                               VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT,
                               VK_ACCESS_2_SHADER_SAMPLED_READ_BIT};
  HostBindings bindings;
  for (const PlanResource& resource : plan.resources) {
    if (resource.slot < 0 || resource.first_instance != no_instance) continue;
    const auto slot = static_cast<size_t>(resource.slot);
    if (slot >= bindings.images.size()) {
      bindings.images.resize(slot + 1);
      bindings.buffers.resize(slot + 1);
      bindings.structures.resize(slot + 1);
    }
    const VkImage image = device.make_image(); // handles of the null device are interchangeable
    bindings.images[slot] = {image, device.make_view(), written, read, 0, 0};
    bindings.buffers[slot] = {reinterpret_cast<VkBuffer>(image), 0, enough, written, read};
    bindings.structures[slot] = {reinterpret_cast<VkAccelerationStructureKHR>(image), written,
                                 read};
  }
  return bindings;
}

} // namespace

std::span<const std::string_view> GraphCounts::keys() {
  static constexpr std::string_view all[] = {"pipelines", "dispatches", "barriers",
                                             "bytes_per_pixel"};
  return all;
}

std::optional<double> GraphCounts::value(std::string_view key) const {
  if (key == "pipelines") return pipelines;
  if (key == "dispatches") return static_cast<double>(dispatches);
  if (key == "barriers") return static_cast<double>(barriers);
  if (key == "bytes_per_pixel") return read_bytes + written_bytes;
  return std::nullopt;
}

CountingDevice::CountingDevice() {
  vulkan::DeviceInput input;
  input.get_instance_proc_addr = NullDevice::loader();
  input.instance = null_.instance();
  input.physical = null_.physical();
  input.device = null_.device();
  [[maybe_unused]] const vulkan::Error error = vulkan::make_device(input, device_);
  assert(!error); // the null device has everything
}

DeviceProfile CountingDevice::profile_for(const vulkan::Device& real) const {
  DeviceProfile profile = vulkan::device_profile(real);
  const DeviceProfile own = vulkan::device_profile(device_);
  // Sizes of images come from this device: drivers without hardware cannot tell them.
  profile.device_local_type_bits = own.device_local_type_bits;
  profile.image_needs = own.image_needs;
  profile.buffer_needs = own.buffer_needs;
  return profile;
}

std::string CountingDevice::count_commands(const Graph& graph, const PassTypeRegistry& pass_types,
                                           const Plan& plan,
                                           std::span<const vulkan::KernelCode> kernels,
                                           std::span<const vulkan::EnvironmentBinding> environment,
                                           GraphCounts& counts) {
  vulkan::ExecutorInput input;
  input.device = &device_;
  input.graph = &graph;
  input.pass_types = &pass_types;
  input.plan = &plan;
  input.kernels = kernels;
  input.environment = environment;
  input.host_pass = [](void*, const vulkan::HostPass&) {};
  std::unique_ptr<vulkan::Executor> executor;
  if (const vulkan::Error error = vulkan::Executor::create(input, executor)) return error.text;
  const HostBindings bindings = bind_all(null_, plan);
  vulkan::FrameInput frame;
  frame.command_buffer = null_.command_buffer();
  frame.images = bindings.images;
  frame.buffers = bindings.buffers;
  frame.structures = bindings.structures;
  for (frame.frame_index = 1; frame.frame_index <= steady_frame; ++frame.frame_index) {
    const uint64_t dispatches = null_.dispatches(), barriers = null_.barriers();
    if (const vulkan::RecordResult refused = executor->record(frame)) return refused.text;
    counts.dispatches = null_.dispatches() - dispatches;
    counts.barriers = null_.barriers() - barriers;
  }
  return "";
}

void count_bytes(const Graph& graph, const PassTypeRegistry& pass_types, const Plan& plan,
                 const TrafficAssumptions& assumptions, GraphCounts& counts) {
  std::vector<PassTraffic> traffic = count_traffic(plan, pass_types, assumptions);
  for (size_t p = 0; p < plan.passes.size(); ++p) {
    if (choice::copies_all_tiles(pass_types[plan.passes[p].type])) traffic[p] = {};
    counts.passes.push_back({graph.passes[plan.passes[p].declared.value].name,
                             std::string(pass_types[plan.passes[p].type].shader), traffic[p]});
    counts.read_bytes += traffic[p].read;
    counts.written_bytes += traffic[p].written;
  }
}

} // namespace dermis::tools
