#pragma once
// The file formats that the command knows, told apart by the version key that each has at its root.

#include "framegraph/text/document.hpp"

#include <cstdint>
#include <span>
#include <string_view>

namespace dermis::tools {

struct FileKind {
  std::string_view version_key, name;
  int64_t version; // the newest one, which is what is read
};

enum class FileKindId : uint8_t {
  graph,
  profile,
  scene,
  expectations,
  capture,
  overlay,
  fragment,
  errors,
  calibration,
  pass_types
};

std::span<const FileKind> file_kinds(); // by FileKindId

// A file without any of the keys, or with a misspelt one, counts as a graph: its reader says what is missing.
FileKindId file_kind_of(const Document& document);

} // namespace dermis::tools
