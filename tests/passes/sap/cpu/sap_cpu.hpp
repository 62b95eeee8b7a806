#pragma once
// The surface-aware pyramid on the CPU, with the steps of the kernels subsurface_sap_*.comp on
// plain arrays. It measures accuracy without a device, and the kernels are tested against it.

#include "passes/common/reference/reference.hpp"
#include "tests/passes/sap/cpu/sap_levels.hpp"

namespace dermis::subsurface {

struct SapOptions {
  SapVariant variant = SapVariant::smooth;
  // The first level whose texels can have two surfaces: 1, or 2 for the variant `half`;
  // sap_level_count: none.
  uint32_t first_layered = 1;
  SapGrid grid{};
  unsigned threads = 0; // 0: one per hardware thread; the result does not depend on it.
};

template <class Real> struct SapResult {
  std::vector<Real> light; // 3 per pixel; pixels without a profile keep their light.
  // In [0, 1]: the fraction of the surface around, weighted by the widest channel's kernel, that
  // the levels represent at this pixel. Missing surface does not count as a loss. 1 where nothing
  // scatters.
  std::vector<Real> confidence;
};

// Scatters the whole input. `table` comes from make_sap_table for the same variant. Each pixel's
// result is a convex mean of light of its own profile: constant light stays constant, and nothing
// leaks from other profiles. The kernels differ only by fp16 storage. Real: float or double.
template <class Real>
SapResult<Real> sap_scatter(const ReferenceInput& input, std::span<const float> table,
                            const SapOptions& options);

} // namespace dermis::subsurface
