#pragma once
// Colours of errors in pictures.

#include <array>
#include <cstdint>

namespace dermis::tools {

// The colour of an error, sRGB: logarithmic from 1e-4 to 1e-1.
std::array<uint8_t, 3> heat_color(double error);

} // namespace dermis::tools
