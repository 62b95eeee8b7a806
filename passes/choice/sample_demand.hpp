#pragma once
// How many samples the tiles of a frame will want from an outcome that gives them by tile, where it does not
// run: what was found when it last ran with a d as large on the screen. Doubt comes with d: far away there is
// none.

#include "passes/choice/sample_allocation.hpp"

#include <array>
#include <cstddef>

namespace dermis::choice {

// Units a scattering tile, by octave of d from 1/8 pixel on; what was never found is all that a tile can
// have.
struct SampleDemand {
  std::array<double, 10> by_octave;

  SampleDemand() { by_octave.fill(max_units); }
};

// d_px > 0: what a frame with this d was found to want, and what is expected of one.
void found_units(SampleDemand& wanted, double d_px, double units_per_tile);
double expected_units(const SampleDemand& wanted, double d_px);

} // namespace dermis::choice
