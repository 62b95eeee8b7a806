#pragma once
// Random numbers of a pixel: a key and a counter, no state beside, so that CPU and device draw the same bits.
// shaders/restir/random.glsl mirrors these functions under the same names. Thread: one state each.

#include "tests/passes/common/cpu/hash.hpp"

#include <cstdint>

namespace dermis::restir {

struct Random {
  uint32_t pixel = 0; // any number of its own for each pixel
  uint32_t frame = 0;
  uint32_t count = 0; // numbers drawn; passes of one frame begin at multiples of random_numbers_a_pass
};

// More than a pass draws: the key of its next number is no other pass's. (Kernels that draw many samples
// begin behind all others: random.glsl.)
inline constexpr uint32_t random_numbers_a_pass = 1024;

// Uniform in (0, 1), 24 bits: the middle of a cell, so that neither 0 nor 1 ever comes.
constexpr double random_unit(Random& random) {
  return ((subsurface::pcg3d({random.pixel, random.frame, random.count++})[0] >> 8) + 0.5) / 16777216.0;
}

} // namespace dermis::restir
