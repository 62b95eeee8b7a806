#pragma once
// Colours of an error map.

#include <array>
#include <cstdint>

namespace dermis::tools {

// Returns the sRGB colour of an error on a logarithmic scale from 1e-4 to 1e-1.
std::array<uint8_t, 3> heat_color(double error);

} // namespace dermis::tools
