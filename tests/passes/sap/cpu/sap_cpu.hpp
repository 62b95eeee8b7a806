#pragma once
// The surface-aware pyramid on the CPU: the same steps as the kernels subsurface_sap_*.comp, on plain arrays,
// so that accuracy is judged without a device and the kernels are checked against it.

#include "passes/common/reference/reference.hpp"
#include "passes/sap/sap_weights.hpp"

namespace dermis::subsurface {

struct SapOptions {
  SapVariant variant = SapVariant::smooth;
  // The first level whose texels can have two surfaces: 2 (sap.json), 1 (sap_layered.json),
  // sap_level_count: none.
  uint32_t first_layered = 2;
  unsigned threads = 0; // 0: one a hardware thread; the result does not depend on it
};

template <class Real> struct SapResult {
  std::vector<Real> light; // 3 per pixel; pixels without profile return their light
  std::vector<Real>
      confidence; // in [0, 1]: the share of the widest channel's kernel that met the pixel's
                  // own tangent plane, and saw it on theirs, under stricter weights; 1 where nothing scatters
};

// Scatters the whole input. `table` comes from make_sap_table for the same variant. Each pixel's result is a
// convex mean of light of its own profile: constant light stays constant, nothing leaks from other profiles.
// Differs from the kernels by their fp16 storage. Real: float or double.
template <class Real>
SapResult<Real> sap_scatter(const ReferenceInput& input, std::span<const float> table,
                            const SapOptions& options);

} // namespace dermis::subsurface
