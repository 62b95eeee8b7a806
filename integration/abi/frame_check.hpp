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
};

// Checks every field, fills program.images and what of `checked` does not hang on the outcome. ARGUMENT or
// VERSION with a message that names the field.
dermis_result check_frame(dermis_view_t& view, Program& program, const dermis_frame& frame,
                          CheckedFrame& checked);
// The rest of `checked`, for one outcome of the program. `taken_over`: its variant did not record the last
// frame. `sample_units`: as FrameConstants.
dermis_result fill_frame(const dermis_view_t& view, const Program& program, uint32_t outcome,
                         const vulkan::Executor* before, uint32_t sample_units, const dermis_frame& frame,
                         CheckedFrame& checked);

} // namespace dermis::abi
