#pragma once
// A host's frame against the program that would record it. Nothing here allocates or changes the graph.

#include "integration/abi/graph.hpp"

namespace dermis::abi {

// The frame as checked: what the executor needs. Spans point into the program or into `constants`.
struct CheckedFrame {
  vulkan::FrameInput input;
  subsurface::FrameConstants constants{};
};

// Checks every field and fills `checked` and program.images. ARGUMENT or VERSION with a message that names
// the field.
dermis_result check_frame(const dermis_graph_t& graph, Program& program, const dermis_frame& frame,
                          CheckedFrame& checked);

} // namespace dermis::abi
