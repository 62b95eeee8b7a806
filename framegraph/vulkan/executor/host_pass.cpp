// Calls the host's function for host-recorded passes, with the resources bound to their ports.
#include "framegraph/vulkan/executor/state.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace dermis::vulkan {
namespace {

HostPort port_now(const State& state, const FrameInput& frame, const PortAccess& bound,
                  bool storage) {
  const uint32_t index = access_now(state, bound);
  if (index == no_index) return {};
  const PlanAccess& access = state.plan.accesses[index];
  const PlanResource& resource = state.plan.resources[access.resource];
  HostPort port;
  port.format = static_cast<VkFormat>(format_info(resource.format).vulkan);
  port.layout = static_cast<VkImageLayout>(access.layout);
  port.width = std::max(resource.width >> access.range.first_mip, 1u);
  port.height = std::max(resource.height >> access.range.first_mip, 1u);
  if (resource.type == ResourceType::acceleration_structure) {
    port = {};
    port.structure = frame.structures[static_cast<size_t>(resource.slot)].structure;
    return port;
  }
  if (resource.first_instance == no_instance && resource.type == ResourceType::buffer) {
    const HostBuffer& buffer = frame.buffers[static_cast<size_t>(resource.slot)];
    port = {};
    port.buffer = buffer.buffer;
    port.offset = buffer.offset;
    port.bytes = buffer.bytes;
    return port;
  }
  if (resource.first_instance == no_instance) {
    const HostImage& image = frame.images[static_cast<size_t>(resource.slot)];
    port.image = image.image;
    port.view = image.view;
    return port;
  }
  const uint32_t number = instance_of(state, resource, access.frames_back);
  const Instance& instance = state.instances[number];
  if (resource.type == ResourceType::buffer) {
    port = {};
    port.buffer = instance.buffer;
    port.bytes = resource.bytes;
    return port;
  }
  const uint32_t first_view = state.view_of_access[index];
  port.image = instance.image;
  port.view = first_view != no_index
                  ? state.subresource_views[first_view + number - resource.first_instance].view
              : storage ? instance.first_mip
                        : instance.all_mips;
  return port;
}

} // namespace

Error check_host_passes(State& state, const ExecutorInput& input) {
  size_t ports = 0, settings = 0;
  for (Pass& pass : state.passes) {
    if (!pass.host.valid()) continue;
    if (input.host_pass == nullptr)
      return {
          ErrorKind::argument, VK_SUCCESS,
          fmt::format("pass '{}' is recorded by the host, but the host provides no function for it",
                      pass.name)};
    const PassType& type = (*input.pass_types)[pass.host];
    pass.host_settings = static_cast<uint32_t>(type.settings.size());
    ports = std::max(ports, type.ports.size());
    settings = std::max(settings, type.settings.size());
  }
  state.host_pass = input.host_pass;
  state.host_pass_user = input.host_pass_user;
  state.host_ports.resize(ports);
  state.host_settings.resize(settings);
  return {};
}

void run_host_pass(State& state, const FrameInput& frame, size_t p,
                   const Rectangle& rectangle) noexcept {
  const Pass& pass = state.passes[p];
  const PlanPass& planned = state.plan.passes[p];
  for (size_t port = 0; port < pass.ports.size(); ++port) {
    const uint32_t bound = pass.ports[port].access;
    const bool storage =
        bound != no_index && (state.plan.accesses[bound].access & access::shader_sampled_read) == 0;
    state.host_ports[port] = port_now(state, frame, pass.ports[port], storage);
  }
  for (uint32_t i = 0; i < pass.host_settings; ++i)
    state.host_settings[i] = value_of(state.plan, planned, i, frame.settings);
  HostPass call;
  call.type = pass.host;
  call.pass = pass.name.c_str();
  call.command_buffer = frame.command_buffer;
  call.ports = {state.host_ports.data(), pass.ports.size()};
  call.settings = {state.host_settings.data(), pass.host_settings};
  call.rectangle = rectangle;
  call.frame_index = frame.frame_index;
  call.view_user = frame.view_user;
  if (frame.host_pass != nullptr)
    frame.host_pass(frame.host_pass_user, call);
  else
    state.host_pass(state.host_pass_user, call);
}

} // namespace dermis::vulkan
