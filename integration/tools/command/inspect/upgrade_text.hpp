#pragma once
// Converts files of format version 1 with the table docs/renames.json.

#include "integration/tools/command/inspect/file_kind.hpp"

#include <optional>
#include <string>
#include <string_view>

namespace dermis::tools {

// Returns the text of docs/renames.json.
std::string_view renames_text();

// Returns `text`, a version 1 file of kind `kind` that was parsed as `document`, in version 2.
// Comments, layout and every value without a new name stay byte for byte. Returns nullopt if the
// kind has only one version.
std::optional<std::string> upgraded_text(const Document& document, FileKindId kind,
                                         std::string_view text);

} // namespace dermis::tools
