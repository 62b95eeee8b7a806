#pragma once

#include <cmath>
#include <numbers>

namespace dermis::subsurface {

// Returns sin(pi x) / (pi x): the transfer function of a box of width 1 at x cycles per width.
inline double sinc(double x) {
  return x == 0 ? 1.0 : std::sin(std::numbers::pi * x) / (std::numbers::pi * x);
}

} // namespace dermis::subsurface
