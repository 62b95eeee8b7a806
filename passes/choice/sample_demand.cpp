#include "passes/choice/sample_demand.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::choice {
namespace {

constexpr double first_octave = -3; // log2 of pixels

size_t octave_of(const SampleDemand& wanted, double d_px) {
  const double last = double(wanted.by_octave.size() - 1);
  return static_cast<size_t>(std::clamp(std::floor(std::log2(d_px) - first_octave), 0.0, last));
}

} // namespace

void found_units(SampleDemand& wanted, double d_px, double units_per_tile) {
  if (d_px > 0) wanted.by_octave[octave_of(wanted, d_px)] = units_per_tile;
}

double expected_units(const SampleDemand& wanted, double d_px) {
  return d_px > 0 ? wanted.by_octave[octave_of(wanted, d_px)] : double(max_units);
}

} // namespace dermis::choice
