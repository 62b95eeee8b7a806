#pragma once
// The rendered scene as rays see it: its meshes where they stand, its lights.

#include "integration/examples/demo_engine/render/renderer.hpp"

namespace demo {

// Places the objects and lights of this moment in renderer.rays, which is made when this is first asked for.
// The device must have ray queries and be idle. Spots shine as points. Errors: environment.
Result<> place_rays(Renderer& renderer, const SceneState& state);

} // namespace demo
