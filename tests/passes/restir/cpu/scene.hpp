#pragma once
// Queries of a scene: probes, surfaces, visibility, lights. On a device the kernel that includes
// shaders/restir/scene.glsl defines equal functions over its acceleration structure; trace_probe
// there returns only one of the hits.

#include "tests/passes/restir/cpu/lights.hpp"
#include "tests/passes/restir/cpu/probe.hpp"

#include <span>

namespace dermis::restir {

struct SurfacePoint {
  Vector3 position{};
  // Geometric, unit length, outwards; densities are per area perpendicular to it.
  Vector3 normal{};
  Vector3 shading{}; // Unit length; used for incoming light.
  uint32_t medium = 0;
};

// `of` is passed to each function. Within a frame a function returns equal results for equal
// arguments.
struct Scene {
  const void* of = nullptr;
  // Finds all hits with surfaces of the medium, front and back, in order of distance; at most the
  // nearest max_probe_hits.
  void (*trace_probe)(const void* of, const ProbeRay& ray, uint32_t medium,
                      ProbeHits& hits) = nullptr;
  SurfacePoint (*surface_at)(const void* of, uint32_t instance, uint32_t primitive,
                             const Barycentrics& barycentrics) = nullptr;
  // Returns whether the segment from the surface to the target is free; ray origins are lifted off
  // the surface.
  bool (*visible)(const void* of, const SurfacePoint& from, const Vector3& target) = nullptr;
  std::span<const Light> lights; // Their fractions sum to 1.
  // Lights of the previous frame, one for one, if they changed; else empty. Only merge_temporal
  // reads them; surfaces keep their current positions.
  std::span<const Light> previous_lights{};
};

} // namespace dermis::restir
