#include "integration/tools/command/inspect/file_kind.hpp"

namespace dermis::tools {
namespace {

constexpr FileKind kinds[] = {
    {"dermis", "graph", 2},
    {"dermis_profile", "profile", 1},
    {"dermis_scene", "scene", 1},
    {"dermis_expect", "expectations", 1},
    {"dermis_capture", "capture", 1},
    {"dermis_overlay", "overlay", 2},
    {"dermis_fragment", "fragment", 2},
    {"dermis_errors", "error table", 2},
    {"dermis_calibration", "calibration", 2},
    {"dermis_pass_types", "pass types", 2},
};

} // namespace

std::span<const FileKind> file_kinds() {
  return kinds;
}

FileKindId file_kind_of(const Document& document) {
  for (size_t i = 0; i < std::size(kinds); ++i)
    if (document.find(document.root(), kinds[i].version_key).valid())
      return static_cast<FileKindId>(i);
  // Key of pass type files in version 1.
  if (document.find(document.root(), "dermis_kinds").valid()) return FileKindId::pass_types;
  return FileKindId::graph;
}

} // namespace dermis::tools
