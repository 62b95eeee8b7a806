#pragma once
// Generated GLSL: one header per kernel with bindings, constants and settings from its signature,
// the values of the options of settings, and the constants that C++ and GLSL share.

#include <string>
#include <vector>

namespace dermis {

struct GeneratedFile {
  // "afis/subsurface_afis.bindings.glsl", "constants.glsl", "options.glsl": the name used by
  // #include.
  std::string name;
  std::string text;
};

// Returns the files of all kernels. Thread: any.
std::vector<GeneratedFile> generated_glsl();

} // namespace dermis
