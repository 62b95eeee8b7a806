#pragma once
// Runs frames of the whole pipeline on the CPU: own samples, history, two passes of neighbours,
// light.

#include "tests/passes/restir/area_reference.hpp"
#include "tests/passes/restir/cpu/reuse.hpp"

namespace dermis::restir::testing {

enum class Reuse : uint32_t { none = 0, temporal = 1, spatial = 2, spatiotemporal = 3 };

struct SequenceSettings {
  Shift shift = Shift::reconnection;
  Reuse reuse = Reuse::spatiotemporal;
  Index index = Index::traced;
  uint32_t width = 16, height = 16, frames = 8;
  uint32_t judged_from = 0; // Earlier frames are not checked.
  // The camera is this many pixels further right in odd frames, which are not checked.
  double jitter = 0;
  std::array<uint32_t, 2> neighbours{4, 2}; // Neighbours of the two spatial passes (R11).
};

struct SequenceResult {
  std::vector<double> region_mean; // Luminance over the checked frames.
  // Mean over pixels of (estimate - reference)^2 in the last checked frame.
  double last_square = 0;
};

// Runs one sequence from an empty history. From frame judged_from on, `lights` replaces the scene's
// lights unless it is empty. Regions and `reference` (luminance per pixel, or empty) belong to even
// frames.
SequenceResult run_sequence(const TriangleScene& scene, const SequenceSettings& settings,
                            const Regions& regions, const std::vector<double>& reference,
                            uint32_t seed, const std::vector<Light>& lights = {});

} // namespace dermis::restir::testing
