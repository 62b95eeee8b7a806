#pragma once
// An ear on its own: a thin bent sheet with a rolled rim, for scenes whose light comes through.

#include "integration/examples/demo_engine/geometry/mesh.hpp"

namespace demo {

// Distance in centimetres; origin in the ear's middle, x to the front of the head, y up, z outwards. Some 6.4
// high, 3.9 wide; the sheet is 0.26 thick, thicker at rim and lobe.
float ear_distance(const glm::vec3& centimetres);

// The surface as a mesh in metres, same axes. `spacing` scales the distance of the grid's planes. Uses two
// threads.
Mesh make_ear(float spacing = 1.0f);

} // namespace demo
