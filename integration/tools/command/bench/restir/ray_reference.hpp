#pragma once
// What paths converge to: the mean of many frames without reuse, by the same kernels. That these meet a
// reference which draws its points by area, and shares no sampler with them, is a test's business
// (WithRayQueries in tests/integration/examples/demo_engine).

#include "integration/tools/command/bench/reference.hpp"
#include "integration/tools/command/bench/restir/ray_frames.hpp"
#include "integration/tools/command/bench/restir/restir_file.hpp"

namespace dermis::tools {

struct RayReference {
  Reference reference; // every pixel with a profile; the 99.9th percentile of its own light is at 1
  double own_mse = 0;  // what chance left in it, exposed: no error below this can be told
};

// Kept in `cache` by a hash of the scene's file, of what the camera sees and of the size of the reference.
demo::Result<RayReference> make_ray_reference(const RayReferenceSize& size, const RayRequest& request,
                                              const SceneRequest& scene, const Subject& subject,
                                              const SubjectOptions& options, const std::string& cache);

} // namespace dermis::tools
