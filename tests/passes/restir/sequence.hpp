#pragma once
// Frames of the whole pipeline on the CPU: own samples, history, neighbours twice, light.

#include "tests/passes/restir/area_reference.hpp"
#include "tests/passes/restir/cpu/reuse.hpp"

namespace dermis::restir::testing {

enum class Reuse : uint32_t { none = 0, temporal = 1, spatial = 2, spatiotemporal = 3 };

struct SequenceSettings {
  Shift shift = Shift::reconnection;
  Reuse reuse = Reuse::spatiotemporal;
  Index index = Index::traced;
  uint32_t width = 16, height = 16, frames = 8;
  uint32_t judged_from = 0; // frames before it are not judged
  double jitter = 0;        // pixels that the camera stands to the right in odd frames, which are not judged
  std::array<uint32_t, 2> neighbours{4, 2}; // of the two spatial passes (R11)
};

struct SequenceResult {
  std::vector<double> region_mean; // luminance over the judged frames
  double last_square = 0; // mean over pixels of (estimate - truth)^2 in the last frame that is judged
};

// One sequence with an empty history. From frame judged_from on `lights` take the place of the scene's, where
// there are any. Regions and `truth` (luminance a pixel, or empty) are those of even frames.
SequenceResult run_sequence(const TriangleScene& scene, const SequenceSettings& settings,
                            const Regions& regions, const std::vector<double>& reference, uint32_t seed,
                            const std::vector<Light>& lights = {});

} // namespace dermis::restir::testing
