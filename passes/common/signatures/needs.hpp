#pragma once
// How large what a port is bound to has to be. Ports of one name mean the same in every kind; what the
// kernels of a pyramid's steps see depends on the level, and only their buffers are here.

#include "framegraph/model/pass_type.hpp"

#include <string_view>

namespace dermis::subsurface {

// Of a kind by its name.
std::span<const PortNeed> needs_of(std::string_view kind);

} // namespace dermis::subsurface
