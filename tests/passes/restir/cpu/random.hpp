#pragma once
// Random numbers of a pixel from a key and a counter without other state, so that CPU and device
// generate equal bits. shaders/restir/random.glsl mirrors these functions under the same names.
// Thread: one state each.

#include "tests/passes/common/cpu/hash.hpp"

#include <cstdint>

namespace dermis::restir {

struct Random {
  uint32_t pixel = 0; // Any number that is unique per pixel.
  uint32_t frame = 0;
  // Count of generated numbers; passes of one frame begin at multiples of random_numbers_a_pass.
  uint32_t count = 0;
};

// More than a pass uses, so that passes never share a key. (Kernels with many samples use keys
// after all others: random.glsl.)
inline constexpr uint32_t random_numbers_a_pass = 1024;

// Returns a uniform number in (0, 1) with 24 bits: the middle of a cell, so never 0 or 1.
constexpr double random_unit(Random& random) {
  return ((subsurface::pcg3d({random.pixel, random.frame, random.count++})[0] >> 8) + 0.5) /
         16777216.0;
}

} // namespace dermis::restir
