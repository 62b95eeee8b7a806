#pragma once
// What is asked of a scene: probes, surfaces, visibility, lights. On a device the kernel that includes
// shaders/restir/scene.glsl defines the same functions over its acceleration structure.

#include "tests/passes/restir/cpu/lights.hpp"
#include "tests/passes/restir/cpu/probe.hpp"

#include <span>

namespace dermis::restir {

struct SurfacePoint {
  Vector3 position{};
  Vector3 normal{};  // geometric, unit length, outwards: densities are per area of it
  Vector3 shading{}; // unit length: light falls in by it
  uint32_t medium = 0;
};

// `of` is handed to each function. Functions answer the same for the same question within a frame.
struct Scene {
  const void* of = nullptr;
  // All hits with surfaces of the medium, front and back, in order of distance; the nearest max_probe_hits.
  void (*trace_probe)(const void* of, const ProbeRay& ray, uint32_t medium, ProbeHits& hits) = nullptr;
  SurfacePoint (*surface_at)(const void* of, uint32_t instance, uint32_t primitive,
                             const Barycentrics& barycentrics) = nullptr;
  // Is the way from the surface (off which rays are lifted) to the target free?
  bool (*visible)(const void* of, const SurfacePoint& from, const Vector3& target) = nullptr;
  std::span<const Light> lights; // shares of all sum to 1
  // Of the frame before, one for one, where they were others; empty where they were the same. Only
  // merge_temporal asks; surfaces stand where they stand now.
  std::span<const Light> previous_lights{};
};

} // namespace dermis::restir
