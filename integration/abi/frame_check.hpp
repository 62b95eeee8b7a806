#pragma once
// Checks a host's frame against the compiled graph that will record it. Allocates no host memory
// and leaves the graph unchanged, except that it creates image views for bindings without one.

#include "integration/abi/graph.hpp"

namespace dermis::abi {

// A checked frame, ready for the executor. Spans refer to the compiled graph or to `constants`.
struct CheckedFrame {
  vulkan::FrameInput input;
  subsurface::FrameConstants constants{};
  std::array<int32_t, 4> bounds{}; // see FrameConstants::bounds
  bool history_invalid = false;    // some history is invalid
  bool history_unread = false;     // no history is read: one is invalid, or the previous camera is

  bool empty_bounds() const { return bounds[2] == 0 || bounds[3] == 0; }
};

// Checks every field, and fills compiled_graph.images and the parts of `checked` that do not depend
// on the chosen configuration. Returns ARGUMENT or VERSION with a message that names the field.
dermis_result check_frame(dermis_view_t& view, CompiledGraph& compiled_graph,
                          const dermis_frame& frame, CheckedFrame& checked);
// The plan that records the frame.
struct Chosen {
  uint32_t configuration = 0, plan = 0; // into the compiled graph
  // executor of the last frame, if it differs from the variant's
  const vulkan::Executor* before = nullptr;
  uint32_t sample_units = 0; // see FrameConstants
  bool probed = false;       // see subsurface::always_probed
};
// Fills the rest of `checked`.
dermis_result fill_frame(const dermis_view_t& view, const CompiledGraph& compiled_graph,
                         const Chosen& chosen, const dermis_frame& frame, CheckedFrame& checked);

} // namespace dermis::abi
