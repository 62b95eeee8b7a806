#pragma once
// The command's file formats, distinguished by the version key at the root of each file.

#include "framegraph/text/document.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace dermis::tools {

struct FileKind {
  std::string_view version_key, name;
  int64_t version; // newest version, the only one that is read
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

// Returns nullopt with an error if no version key is known.
std::optional<FileKindId> file_kind_of(const Document& document, Diagnostics& diagnostics);

} // namespace dermis::tools
