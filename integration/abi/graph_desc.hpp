#pragma once
// Checks and copies the host's graph description. Keeps no pointers to host memory.

#include "integration/abi/compiled_graph.hpp"

namespace dermis::abi {

inline constexpr uint32_t max_view_side = 16384; // pixels per side
inline constexpr uint32_t largest_profile_id = 255;

// Checks name, text and length of a source. `what` names the function and the field.
dermis_result read_source(const Log& log, const char* what, const dermis_source& source,
                          std::string& name, std::string& text);
// Reads the profile with number out.id. Errors in its text go to `diagnostics`; `out` is then
// unchanged.
dermis_result read_profile_source(const Log& log, const char* what, const dermis_source& source,
                                  subsurface::NumberedProfile& out, Diagnostics& diagnostics);
dermis_result check_view_size(const Log& log, const char* function, uint32_t width,
                              uint32_t height);

// Replaces the parts of `input` that are not in desc.keep. Errors in profile texts go to
// `diagnostics`. `function` is named in messages.
dermis_result read_graph_desc(const Log& log, const char* function, const dermis_graph_desc& desc,
                              CompiledGraphInput& input, Diagnostics& diagnostics);

} // namespace dermis::abi
