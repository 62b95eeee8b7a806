#pragma once
// What every estimator must converge to, by a sampler that shares nothing with probes: x2 uniform by area
// over all triangles of a medium, a light and a place on it uniform, one shadow ray.

#include "tests/passes/restir/statistics.hpp"
#include "tests/passes/restir/triangle_scene.hpp"

namespace dermis::restir::testing {

// Parts of the picture that are judged one by one: each instance's pixels that face a light, and those that
// do not. Parts of fewer than min_pixels are left out.
struct Regions {
  std::vector<std::vector<uint32_t>> pixels; // indices
};
inline constexpr size_t min_pixels = 6;
Regions regions_of(const std::vector<Pixel>& pixels);

// Mean luminance of each region for `batches` independent batches of `points` draws for each medium; all
// pixels of a batch see the same draws. [region][batch]
std::vector<std::vector<double>> area_reference(const TriangleScene& scene, const std::vector<Pixel>& pixels,
                                                const Regions& regions, uint32_t batches, uint32_t points,
                                                uint32_t seed);

} // namespace dermis::restir::testing
