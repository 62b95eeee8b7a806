#pragma once
// A sculpted head on shoulders, made of signed distances: what the default scene shows without any file.

#include "integration/examples/demo_engine/geometry/field.hpp"
#include "integration/examples/demo_engine/geometry/mesh.hpp"

namespace demo {

// Distance in centimetres; origin between the eyes' centres and behind them, x to the subject's left, y up, z
// to the front. Chin to crown is 24.
float bust_distance(const glm::vec3& centimetres);

// The surface as a mesh in metres, same axes; tint and gloss carry what depends on the place: lips, cheeks,
// ears, nose, brows. `spacing` scales the distance of the grid's planes: 1.5 gives some 43,000 triangles, and
// every doubling a quarter of them. Uses two threads.
Mesh make_bust(float spacing = 1.5f);

} // namespace demo
