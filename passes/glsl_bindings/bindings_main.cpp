// Build tool that writes the GLSL generated from signatures. Usage: write_bindings <output folder>
#include "passes/glsl_bindings/bindings.hpp"

#include <fmt/format.h>

#include <fstream>

namespace {

bool write(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  if (file.flush()) return true;
  fmt::print(stderr, "write_bindings: cannot write {}\n", path);
  return false;
}

} // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: write_bindings <output folder>\n");
    return 2;
  }
  for (const dermis::GeneratedFile& file : dermis::generated_glsl())
    if (!write(fmt::format("{}/{}", argv[1], file.name), file.text)) return 1;
  return 0;
}
