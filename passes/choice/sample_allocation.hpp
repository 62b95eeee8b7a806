#pragma once
// Allocation of samples to tiles: the rule of shaders/sap/subsurface_allocate_samples.comp on the
// CPU, bit for bit (shaders/sap/sample_allocation.glsl). The priority of a step of samples is the
// tile's error times the step's reduction of the error, divided by its cost.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace dermis::choice {

inline constexpr int allocation_steps = 3;
inline constexpr uint32_t allocation_bins = 256;
inline constexpr uint32_t no_bin = 0xffffffffu;
// Fraction of a tile's error that each step removes, per unit of cost. Half of the error is that of
// the pyramid's half of the blend. The error of the samples' half falls as n^-0.7
// (docs/techniques.md, `fixed`), and is half of the pyramid's at 8 samples. This gives errors 1,
// 0.75, 0.654, 0.595 at 0, 8, 16, 32 samples, which cost 0, 1, 2 and 4 units.
inline constexpr std::array<float, allocation_steps> allocation_gain = {0.25f, 0.096f, 0.0295f};
inline constexpr double max_units = 4; // cost of all steps of a tile, in units
// factor on the priority of steps that a tile had in the previous frame
inline constexpr float allocation_stay = 1.2f;
// Exponent and three bits of 2^-12, the lowest priority with its own bin: the smallest error of a
// single pixel.
inline constexpr int32_t allocation_first_bin = 115 * 8;

// Returns the cost of step k in units; a unit is 8 samples per pixel of the tile.
uint32_t step_cost(int k);
int samples_of(uint32_t steps); // Returns the samples per pixel.
// Returns the bin of step k for a tile with `tile_error` that took `before` steps in the frame
// before. no_bin: never.
uint32_t step_bin(uint32_t tile_error, int k, uint32_t before);

struct SampleAllocation {
  std::vector<uint32_t> steps; // by tile
  uint32_t units = 0;          // units spent
  uint32_t demand = 0;         // units that all tiles would take
};
// Allocates samples. `tile_errors`: by tile, row by row. `before`: steps of the previous frame by
// tile, or empty. Spends at most `units`.
SampleAllocation allocate_samples(std::span<const uint32_t> tile_errors,
                                  std::span<const uint32_t> before, uint32_t units);

} // namespace dermis::choice
