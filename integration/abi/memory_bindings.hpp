#pragma once
// Buffers and acceleration structures of a host's frame against the slots of the program that would record
// it.

#include "integration/abi/graph.hpp"

namespace dermis::abi {

inline vulkan::HostState host_state(const dermis_image_state& state) {
  return {state.layout, state.queue_family, state.stages, state.access};
}

// Checks every field and fills program.buffers and program.structures. ARGUMENT or VERSION with a message
// that names the field. Allocates nothing.
dermis_result check_memory_bindings(dermis_view_t& view, Program& program, const dermis_frame& frame);

} // namespace dermis::abi
