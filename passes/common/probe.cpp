#include "passes/common/probe.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace dermis::subsurface {
namespace {

// Returns the 97.5 % quantile of Student's t by Cornish and Fisher's expansion about the normal
// distribution, within 1 % from two degrees of freedom on.
double student_t(double freedom) {
  if (freedom < 2) return 12.706;
  constexpr double z = 1.959964, z3 = z * z * z, z5 = z3 * z * z, z7 = z5 * z * z;
  const double n = freedom;
  return z + (z3 + z) / (4 * n) + (5 * z5 + 16 * z3 + 3 * z) / (96 * n * n) +
         (3 * z7 + 19 * z5 + 17 * z3 - 15 * z) / (384 * n * n * n) +
         (freedom < 3 ? 0.45 : 0.0); // correction of the expansion at two degrees of freedom
}

} // namespace

ProbedError probed_error(const FrameCounters& counters) {
  const auto count = std::min<size_t>(counters.probe_count, counters.probes.size());
  double errors = 0, unscattered = 0, separable = 0, pixels = 0;
  std::array<std::array<double, 4>, max_probes> tiles{};
  const auto value = [](uint32_t bits) { return double(std::bit_cast<float>(bits)); };
  for (size_t i = 0; i < count; ++i)
    tiles[i] = {value(counters.probes[i][0]), value(counters.probed_unscattered[i]),
                value(counters.probes[i][1]), value(counters.probed_separable[i])};
  for (const auto& tile : tiles) // extreme exposures overflow
    if (!std::ranges::all_of(tile, [](double one) { return std::isfinite(one); })) return {};
  // the device writes them in any order
  std::sort(tiles.begin(), tiles.begin() + std::ptrdiff_t(count));
  for (const auto& [error, unscattered_error, weight, separable_error] : tiles) {
    errors += error;
    unscattered += unscattered_error;
    separable += separable_error;
    pixels += weight;
  }
  if (!(pixels > 0)) return {};
  ProbedError out;
  out.tiles = static_cast<uint32_t>(count);
  const double mean = errors / pixels;
  out.square = mean;
  out.unscattered_square = unscattered / pixels;
  out.separable_square = separable / pixels;
  out.rmse = std::sqrt(std::max(mean, 0.0));
  out.high = std::numeric_limits<double>::infinity();
  if (count < 2) return out;
  double squares = 0;
  for (size_t i = 0; i < count; ++i)
    squares += std::pow(tiles[i][0] - mean * tiles[i][2], 2);
  const auto n = double(count);
  const double half = student_t(n - 1) * std::sqrt(squares * n / (n - 1)) / pixels;
  out.low = std::sqrt(std::max(mean - half, 0.0));
  out.high = std::sqrt(std::max(mean + half, 0.0));
  return out;
}

} // namespace dermis::subsurface
