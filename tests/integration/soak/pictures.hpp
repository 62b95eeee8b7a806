#pragma once
// Random surfaces and light for a frame of the soak, with damage that hosts can cause.

#include "framegraph/model/splitmix.hpp"

#include <cstdint>
#include <vector>

namespace dermis::abi_test {

inline constexpr uint32_t soak_side = 48; // Pixels of the largest view: six tiles.

// Returns a number from 0 to 1.
double unit(SplitMix64& random);

struct Surface {
  std::vector<float> depth;    // Metres; 0: no surface.
  std::vector<float> material; // Profile id.
  std::vector<float> velocity; // 2 values per pixel, in pixels.
};
// Returns planes, steps, balls in front of nothing, hairs, single pixels, two profiles in cells, or
// nothing.
Surface draw_surface(SplitMix64& random);

struct Light {
  std::vector<float> texels; // 4 values per pixel.
  // The brightest valid value; values that are not finite or negative are repaired.
  double brightest = 0;
  bool even = false; // Equal everywhere, without damage.
};
// Returns even light, edges, spots and noise at levels from 1e-4 to 6e4. With `damaged`, some of it
// is NaN, infinite or negative.
Light draw_light(SplitMix64& random, bool damaged);

} // namespace dermis::abi_test
