#include "integration/tools/command/inspect/file_kind.hpp"

#include "framegraph/text/reader.hpp"
#include "framegraph/text/suggest.hpp"

#include <fmt/format.h>

#include <string>
#include <vector>

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

void report_unknown_kind(const Document& document, Diagnostics& diagnostics) {
  std::vector<std::string_view> keys;
  std::string listed;
  for (const FileKind& kind : kinds) {
    keys.push_back(kind.version_key);
    listed += fmt::format("{}\"{}\": {} ({})", listed.empty() ? "" : ", ", kind.version_key,
                          kind.version, kind.name);
  }
  for (const NodeId child : children(document, document.root()))
    if (const std::string hint = did_you_mean(document.key(child), keys); !hint.empty()) {
      diagnostics
          .add(DiagnosticId::unknown_key, document.where_key(child),
               fmt::format("'{}' is not the version key of a file", document.key(child)))
          .suggestion = hint;
      return;
    }
  diagnostics
      .add(DiagnosticId::missing_key, document.where(document.root()),
           "the file must state its kind and format version")
      .suggestion = fmt::format("add one of {}", listed);
}

} // namespace

std::span<const FileKind> file_kinds() {
  return kinds;
}

std::optional<FileKindId> file_kind_of(const Document& document, Diagnostics& diagnostics) {
  const NodeId root = document.root();
  if (!expect_kind(document, root, "the file", NodeKind::object, diagnostics)) return std::nullopt;
  for (size_t i = 0; i < std::size(kinds); ++i)
    if (document.find(root, kinds[i].version_key).valid()) return static_cast<FileKindId>(i);
  // Key of pass type files in version 1.
  if (document.find(root, "dermis_kinds").valid()) return FileKindId::pass_types;
  report_unknown_kind(document, diagnostics);
  return std::nullopt;
}

} // namespace dermis::tools
