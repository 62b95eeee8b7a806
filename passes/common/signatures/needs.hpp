#pragma once
// Minimum sizes of resources bound to ports. Ports of one name have the same size in every pass
// type. The image sizes of a pyramid's steps depend on the level, so only their buffers are listed
// here.

#include "framegraph/model/pass_type.hpp"

#include <string_view>

namespace dermis::subsurface {

// Returns the needs of a pass type by its name.
std::span<const PortNeed> needs_of(std::string_view pass_type);

} // namespace dermis::subsurface
