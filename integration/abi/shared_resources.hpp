#pragma once
// One image, buffer or acceleration structure of the host in two slots of a frame.

#include "integration/abi/graph.hpp"

namespace dermis::abi {

// Refuses what two bindings have in common, unless both are only read, have equal states, and need no
// transition: barriers of one slot know nothing of the other. After the bindings themselves were checked.
// ARGUMENT with the names of both slots. Allocates nothing.
dermis_result check_shared_resources(const dermis_view_t& view, const Program& program);

} // namespace dermis::abi
