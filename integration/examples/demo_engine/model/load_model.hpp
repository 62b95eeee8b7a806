#pragma once
// glTF files and their maps, as things to draw. Files are hostile until checked.

#include "integration/examples/demo_engine/engine.hpp"
#include "integration/examples/demo_engine/render/scene_gpu.hpp"

namespace demo {

// All triangles of the file's default scene in one mesh, moved so that the middle of its bounds is the origin
// and scaled to the wanted height. Maps given in `options` take the place of those of the first material.
// Buffers and pictures that the file names are read from its own folder, from folders below it, and from
// below `roots`. Errors: input, with file, what is wrong and what was expected; usage (a height that is no
// length).
Result<Model> load_model(const ModelOptions& options, const std::vector<std::string>& roots = {});

} // namespace demo
