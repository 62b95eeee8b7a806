#pragma once
// Simple objects of the scenes, in closed form. Metres; the origin is the middle of the foot unless
// noted otherwise.

#include "integration/examples/demo_engine/geometry/mesh.hpp"

namespace demo {

// Returns a ball of radius 1 around the origin.
Mesh make_sphere();
// Returns the square [-1, 1]^2 in x and z, facing +y.
Mesh make_plane();
// Returns the box [-1, 1]^3 with flat faces.
Mesh make_box();
// Returns a carved ring: a trefoil knot of fluted tube, upright in the plane of x and y, 0.12 m
// high, resting on y = 0.
Mesh make_knot();
// Returns a candle 0.13 m high with a burnt-out hollow, thin rim and run-down wax; radius 0.032 m.
Mesh make_candle();

} // namespace demo
