#pragma once
// A sculpted head on shoulders, made of signed distances: the object of the default scene, without
// any file.

#include "integration/examples/demo_engine/geometry/field.hpp"
#include "integration/examples/demo_engine/geometry/mesh.hpp"

namespace demo {

// Returns the distance in centimetres. Origin between and behind the centres of the eyes, x to the
// subject's left, y up, z to the front. The height from chin to crown is 24 cm.
float bust_distance(const glm::vec3& centimetres);

// Returns the surface as a mesh in metres with the same axes. Tint and gloss vary with the place:
// lips, cheeks, ears, nose, brows. `spacing` scales the distance of the grid's planes: 1.5 gives
// about 43,000 triangles, and doubling it gives a quarter of them. Uses two threads.
Mesh make_bust(float spacing = 1.5f);

} // namespace demo
