#pragma once
// A sculpted head on shoulders, made of signed distances: what the default scene shows without any file.

#include "integration/demo_engine/geometry/field.hpp"
#include "integration/demo_engine/geometry/mesh.hpp"

namespace demo {

// Distance in centimetres; origin between the eyes' centres and behind them, x to the subject's left, y up, z
// to the front. Chin to crown is 24.
float bust_distance(const glm::vec3& centimetres);

// The surface as a mesh in metres, same axes; tint carries what depends on the place: lips, cheeks, ears,
// nose. `detail` scales the spacing of the grid (1 = some 80,000 triangles, 2 = a quarter of them). Uses two
// threads.
Mesh make_bust(float detail = 1.0f);

} // namespace demo
