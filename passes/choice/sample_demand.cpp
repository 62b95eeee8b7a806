#include "passes/choice/sample_demand.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::choice {
namespace {

constexpr double first_octave = -3; // log2 of pixels

size_t octave_of(const SampleDemand& demand, double d_px) {
  const double last = double(demand.by_octave.size() - 1);
  return static_cast<size_t>(std::clamp(std::floor(std::log2(d_px) - first_octave), 0.0, last));
}

} // namespace

void record_units(SampleDemand& demand, double d_px, double units_per_tile) {
  if (d_px <= 0) return;
  const size_t octave = octave_of(demand, d_px);
  demand.by_octave[octave] = std::max(units_per_tile, min_units_per_tile);
  demand.known[octave] = true;
}

double expected_units(const SampleDemand& demand, double d_px) {
  return d_px > 0 ? demand.by_octave[octave_of(demand, d_px)] : double(max_units);
}

double likely_units(const SampleDemand& demand, double d_px) {
  if (d_px <= 0) return double(max_units);
  const size_t octave = octave_of(demand, d_px), count = demand.by_octave.size();
  for (size_t distance = 0; distance < count; ++distance) {
    if (octave + distance < count && demand.known[octave + distance])
      return demand.by_octave[octave + distance];
    if (distance <= octave && demand.known[octave - distance])
      return demand.by_octave[octave - distance];
  }
  return double(max_units);
}

} // namespace dermis::choice
