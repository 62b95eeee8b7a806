#pragma once
// A triangle mesh of the zero set of a signed distance field: surface nets (Gibson 1998) on a grid whose
// planes may stand closer where detail is wanted, then a few Newton steps onto the surface.

#include "integration/examples/demo_engine/geometry/field.hpp"
#include "integration/examples/demo_engine/geometry/mesh.hpp"

#include <vector>

namespace demo {

// Positions of the grid's planes, ascending, at least 2 an axis. The surface must lie strictly inside.
struct GridPlanes {
  std::vector<float> x, y, z;
};

// Planes from `low` to `high` whose distance at position p is about spacing(p).
std::vector<float> place_planes(float low, float high, const std::function<float(float)>& spacing);

// Positions, normals (gradient of the field) and openness (surface within `occlusion_reach` darkens); the
// rest of the vertices is default. `field` is called from two threads at once. Deterministic.
Mesh mesh_field(const Field& field, const GridPlanes& planes, float occlusion_reach);

} // namespace demo
