#include "integration/tools/files/heat_color.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>

namespace dermis::tools {
namespace {

constexpr double minimum = -4, maximum = -1; // log10 of the error at both ends of the scale

} // namespace

// Lightness grows monotonically, so that the map is also readable in grey.
std::array<uint8_t, 3> heat_color(double error) {
  constexpr double stops[][3] = {{12, 12, 40},  {60, 20, 110},  {160, 40, 110},
                                 {235, 95, 60}, {252, 180, 60}, {252, 250, 190}};
  constexpr size_t last = std::size(stops) - 1;
  if (std::isnan(error)) error = HUGE_VAL;
  const double t =
      std::clamp((std::log10(std::max(error, 1e-30)) - minimum) / (maximum - minimum), 0.0, 1.0) *
      double(last);
  const size_t k = std::min(static_cast<size_t>(t), last - 1);
  std::array<uint8_t, 3> rgb{};
  for (size_t c = 0; c < 3; ++c)
    rgb[c] =
        static_cast<uint8_t>(stops[k][c] + (t - double(k)) * (stops[k + 1][c] - stops[k][c]) + 0.5);
  return rgb;
}

} // namespace dermis::tools
