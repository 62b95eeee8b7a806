#pragma once
// Triangle mesh of the zero set of a signed distance field: surface nets (Gibson 1998) on a grid
// with variable plane distances, followed by a few Newton steps onto the surface.

#include "integration/examples/demo_engine/geometry/field.hpp"
#include "integration/examples/demo_engine/geometry/mesh.hpp"

#include <vector>

namespace demo {

// Positions of the grid's planes, ascending, at least 2 per axis. The surface must lie strictly
// inside.
struct GridPlanes {
  std::vector<float> x, y, z;
};

// Returns planes from `low` to `high` whose distance at position p is about spacing(p).
std::vector<float> place_planes(float low, float high, const std::function<float(float)>& spacing);

// Returns a mesh with positions, normals (gradient of the field) and openness (surface within
// `occlusion_reach` darkens); other vertex members keep their defaults. Calls `field` from two
// threads at once. Deterministic.
Mesh mesh_field(const Field& field, const GridPlanes& planes, float occlusion_reach);

} // namespace demo
