// Replaces the compiler in libraries that are built without one.
#include "integration/abi/shaders/compiler.hpp"

namespace dermis::abi {

std::string shader_compiler() {
  return "";
}

bool compile_shaders(std::span<const std::string>, const OpenFile&,
                     std::vector<std::vector<uint32_t>>&, Diagnostics& diagnostics) {
  diagnostics.add(DiagnosticId::no_shader_compiler, {},
                  "this library compiles no shaders at run time");
  return false;
}

} // namespace dermis::abi
