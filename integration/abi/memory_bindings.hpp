#pragma once
// Checks buffers and acceleration structures of a host's frame against the slots of the compiled
// graph that will record it.

#include "integration/abi/graph.hpp"

namespace dermis::abi {

inline vulkan::HostState host_state(const dermis_image_state& state) {
  const uint32_t family = state.transfer != 0 ? state.queue_family : VK_QUEUE_FAMILY_IGNORED;
  return {state.layout, family, state.stages, state.access};
}

// Returns what is wrong with the queue family of a state, as "field is value, explanation"; empty:
// nothing.
using FamilyText = std::array<char, 256>;
std::string_view family_problem(const dermis_context_t& context, ResourceType type,
                                const dermis_image_state& state, FamilyText& text);

// Checks every field and fills compiled_graph.buffers and compiled_graph.structures. Returns
// ARGUMENT or VERSION with a message that names the field. Allocates nothing.
dermis_result check_memory_bindings(dermis_view_t& view, CompiledGraph& compiled_graph,
                                    const dermis_frame& frame);

} // namespace dermis::abi
