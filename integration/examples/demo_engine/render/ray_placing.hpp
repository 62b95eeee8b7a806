#pragma once
// Converts the rendered scene to the ray scene: placed meshes and lights.

#include "integration/examples/demo_engine/render/renderer.hpp"

namespace demo {

// Places the present objects and lights in renderer.rays, which is created on the first call. The
// device must have ray queries and be idle. Spots are treated as points. Errors: environment.
Result<> place_rays(Renderer& renderer, const SceneState& state);

} // namespace demo
