#pragma once
// A single ear: a thin bent sheet with a rolled rim, for scenes with transmitted light.

#include "integration/examples/demo_engine/geometry/mesh.hpp"

namespace demo {

// Returns the distance in centimetres. Origin in the ear's middle, x to the front of the head, y
// up, z outwards. The ear is about 6.4 cm high and 3.9 cm wide; the sheet is 0.26 cm thick, thicker
// at rim and lobe.
float ear_distance(const glm::vec3& centimetres);

// Returns the surface as a mesh in metres with the same axes. `spacing` scales the distance of the
// grid's planes. Uses two threads.
Mesh make_ear(float spacing = 1.0f);

} // namespace demo
