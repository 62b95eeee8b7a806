#pragma once
// Predicts the sample demand of a configuration with samples by tile in frames where it does not
// run, from its last frame with a similar d on the screen. The demand depends on d: there is none
// far away.

#include "passes/choice/sample_allocation.hpp"

#include <array>
#include <cstddef>

namespace dermis::choice {

// Least demand that is expected. With 0, as where all importance was 0, samples would never be
// tried again.
inline constexpr double min_units_per_tile = 1.0 / 16;

// Units per scattering tile, by octave of d from 1/8 pixel on. An octave without observations has
// the maximum of a tile.
struct SampleDemand {
  std::array<double, 10> by_octave;
  std::array<bool, 10> known{};

  SampleDemand() { by_octave.fill(max_units); }
};

// Record or return the units per tile of a frame with this d. d_px > 0.
void record_units(SampleDemand& demand, double d_px, double units_per_tile);
double expected_units(const SampleDemand& demand, double d_px);
// Like expected_units, but falls back to the nearest octave with an observation.
double likely_units(const SampleDemand& demand, double d_px);

} // namespace dermis::choice
