#pragma once
// GLSL that is written by the program: one header a kernel from its signature, so that bindings and push
// constants are written once, and the numbers that C++ and GLSL must agree on.

#include <string>
#include <vector>

namespace dermis {

struct GeneratedFile {
  std::string name; // "afis/subsurface_afis.bindings.glsl", "constants.glsl"; what #include names
  std::string text;
};

// Those of all kernels. Free-threaded.
std::vector<GeneratedFile> generated_glsl();

} // namespace dermis
