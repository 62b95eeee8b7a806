#pragma once
// Checks images, buffers and acceleration structures that are bound to two slots of a frame.

#include "integration/abi/graph.hpp"

namespace dermis::abi {

// Rejects overlapping bindings, unless both are only read, have equal states, and need no
// transition: barriers of one slot do not account for the other. Call it after the bindings were
// checked. Returns ARGUMENT with the names of both slots. Allocates nothing.
dermis_result check_shared_resources(const dermis_view_t& view,
                                     const CompiledGraph& compiled_graph);

} // namespace dermis::abi
