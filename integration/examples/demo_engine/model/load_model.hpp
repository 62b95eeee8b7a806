#pragma once
// Loads glTF files and their maps for rendering. Files are hostile until checked.

#include "integration/examples/demo_engine/engine.hpp"
#include "integration/examples/demo_engine/render/scene_gpu.hpp"

namespace demo {

// Returns all triangles of the file's default scene in one mesh, centred on the middle of its
// bounds and scaled to the requested height. Maps in `options` replace those of the first material.
// Buffers and pictures that the file names are read from its own folder, from folders below it, and
// from below `roots`. Errors: input, with the file, what is wrong and what was expected; usage (an
// invalid height).
Result<Model> load_model(const ModelOptions& options, const std::vector<std::string>& roots = {});

} // namespace demo
