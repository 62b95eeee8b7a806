#pragma once
// The simpler things of the scenes, in closed form. Metres; origin at the middle of the foot unless said
// otherwise.

#include "integration/examples/demo_engine/geometry/mesh.hpp"

namespace demo {

// A ball of radius 1 around the origin.
Mesh make_sphere();
// The square [-1, 1]^2 in x and z, facing +y.
Mesh make_plane();
// The box [-1, 1]^3 with flat faces.
Mesh make_box();
// A carved ring: a trefoil knot of fluted tube, upright in the plane of x and y, 0.12 high, standing on y =
// 0.
Mesh make_knot();
// A candle 0.13 high with a burnt-out hollow, thin rim and run-down wax; radius 0.032.
Mesh make_candle();

} // namespace demo
