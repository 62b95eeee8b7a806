#pragma once
// The reference for every estimator, by a sampler that shares nothing with probes: x2 uniform by
// area over all triangles of a medium, a uniform light with a uniform place on it, and one shadow
// ray.

#include "tests/passes/restir/statistics.hpp"
#include "tests/passes/restir/triangle_scene.hpp"

namespace dermis::restir::testing {

// Parts of the picture that are checked separately: the pixels of each instance that face a light,
// and those that do not. Parts of fewer than min_pixels are left out.
struct Regions {
  std::vector<std::vector<uint32_t>> pixels; // Pixel indices.
};
inline constexpr size_t min_pixels = 6;
Regions regions_of(const std::vector<Pixel>& pixels);

// Returns the mean luminance of each region for `batches` independent batches of `points` samples
// per medium; all pixels of a batch use equal samples. Indexed [region][batch].
std::vector<std::vector<double>> area_reference(const TriangleScene& scene,
                                                const std::vector<Pixel>& pixels,
                                                const Regions& regions, uint32_t batches,
                                                uint32_t points, uint32_t seed);

} // namespace dermis::restir::testing
