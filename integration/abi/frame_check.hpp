#pragma once
// A host's frame against the program that would record it. Nothing here allocates host memory or changes the
// graph, but that image views are made for bindings without.

#include "integration/abi/graph.hpp"

namespace dermis::abi {

// The frame as checked: what the executor needs. Spans point into the program or into `constants`.
struct CheckedFrame {
  vulkan::FrameInput input;
  subsurface::FrameConstants constants{};
  std::array<int32_t, 4> bounds{}; // as FrameConstants::bounds
  bool history_invalid = false;    // of any history

  bool empty_bounds() const { return bounds[2] == 0 || bounds[3] == 0; }
};

// Checks every field, fills program.images and what of `checked` does not hang on the outcome. ARGUMENT or
// VERSION with a message that names the field.
dermis_result check_frame(dermis_view_t& view, Program& program, const dermis_frame& frame,
                          CheckedFrame& checked);
struct Chosen {                             // what records the frame
  uint32_t outcome = 0, variant = 0;        // of the program
  const vulkan::Executor* before = nullptr; // that recorded the last frame, if the variant did not
  uint32_t sample_units = 0;                // as FrameConstants
};
// Fills the rest of `checked`.
dermis_result fill_frame(const dermis_view_t& view, const Program& program, const Chosen& chosen,
                         const dermis_frame& frame, CheckedFrame& checked);

} // namespace dermis::abi
