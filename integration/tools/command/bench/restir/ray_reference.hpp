#pragma once
// The limit of path sampling: the mean of many frames without reuse, by the same kernels. The test
// WithRayQueries in tests/integration/examples/demo_engine compares these kernels with an
// independent reference that samples points by area.

#include "integration/tools/command/bench/reference.hpp"
#include "integration/tools/command/bench/restir/ray_frames.hpp"
#include "integration/tools/command/bench/restir/restir_file.hpp"

namespace dermis::tools {

struct RayReference {
  // every pixel with a profile; exposure from its own light's 99.9th percentile
  Reference reference;
  double own_mse = 0; // Remaining variance, exposed: smaller errors are not measurable.
};

// Cached in `cache` by a hash of the scene's file, of the camera's view and of the reference's
// size.
demo::Result<RayReference> make_ray_reference(const RayReferenceSize& size,
                                              const RayRequest& request, const SceneRequest& scene,
                                              const Subject& subject, const SubjectOptions& options,
                                              const std::string& cache);

} // namespace dermis::tools
