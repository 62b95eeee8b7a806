#pragma once
// What a frame of the soak shows: surfaces and light drawn at random, damaged as hosts damage them.

#include "framegraph/model/splitmix.hpp"

#include <cstdint>
#include <vector>

namespace dermis::abi_test {

inline constexpr uint32_t soak_side = 48; // pixels, the largest view: six tiles

// A number from 0 to 1.
double unit(SplitMix64& random);

struct Surface {
  std::vector<float> depth;    // metres, 0: nothing there
  std::vector<float> material; // profile id
  std::vector<float> velocity; // 2 a pixel, pixels
};
// Planes, steps, balls before nothing, hairs, single pixels, two profiles in cells, nothing at all.
Surface draw_surface(SplitMix64& random);

struct Light {
  std::vector<float> texels; // 4 a pixel
  double brightest = 0;      // that counts: what is not finite or negative is repaired
  bool even = false;         // the same everywhere, without damage
};
// Even, edges, spots and noise at levels from 1e-4 to 6e4, some of it NaN, infinite or negative.
Light draw_light(SplitMix64& random, bool damaged);

} // namespace dermis::abi_test
