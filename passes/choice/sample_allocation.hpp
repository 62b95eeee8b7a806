#pragma once
// Which tiles get samples, and how many: the rule of shaders/sap/subsurface_allocate_samples.comp on the CPU,
// bit for bit (shaders/sap/sample_allocation.glsl). A step of samples is worth the tile's doubt times what
// the step takes off its error, over what it costs.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace dermis::choice {

inline constexpr int allocation_steps = 3;
inline constexpr uint32_t allocation_bins = 256;
inline constexpr uint32_t no_bin = 0xffffffffu;
// Share of a tile's error that each step takes off, for one unit of cost. Half of the error stays with the
// pyramid's half of the blend; the samples' own half falls as n^-.7 (docs/techniques.md, of `fixed`), and is
// taken as half of the pyramid's at 8 samples: errors 1, .75, .654, .595 at 0, 8, 16, 32 samples, which cost
// 0, 1, 2 and 4 units.
inline constexpr std::array<float, allocation_steps> allocation_gain = {0.25f, 0.096f, 0.0295f};
inline constexpr double max_units = 4;         // of a tile: the cost of all steps
inline constexpr float allocation_stay = 1.2f; // factor on what a tile had in the frame before
// Exponent and three bits of the least priority that has a bin of its own, 2^-12: a single pixel's least
// doubt.
inline constexpr int32_t allocation_first_bin = 115 * 8;

uint32_t step_cost(int k);      // units: 8 samples a pixel of the tile are one
int samples_of(uint32_t steps); // a pixel
// Of step k of a tile with `doubt` that took `before` steps in the frame before; no_bin: never.
uint32_t step_bin(uint32_t tile_error, int k, uint32_t before);

struct SampleAllocation {
  std::vector<uint32_t> steps; // by tile
  uint32_t units = 0;          // spent
  uint32_t wanted = 0;         // that all tiles would take
};
// `doubts`: by tile, row by row. `before`: the same, or empty. The units that are spent are at most `units`.
SampleAllocation allocate_samples(std::span<const uint32_t> tile_errors, std::span<const uint32_t> before,
                                  uint32_t units);

} // namespace dermis::choice
