#pragma once
// One message with a stable id: what, where, what was expected, what to do. Errors are values.

#include "framegraph/text/index.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace dermis {

// Where a value stands in the text it was read from. Lines and columns count from 1, columns in bytes.
struct SourceLocation {
  FileId file;                   // into Diagnostics::files; invalid: no file at all
  uint32_t line = 0, column = 0; // 0: the file as a whole
  std::string pointer;           // JSON pointer (RFC 6901), "" for the root
};

enum class Severity : uint8_t { note, warning, error };

enum class DiagnosticId : uint16_t {
#define DERMIS_DIAGNOSTIC(id, name, severity, hint) name = id,
#include "framegraph/text/diagnostics.def"
#undef DERMIS_DIAGNOSTIC
};

struct DiagnosticInfo {
  DiagnosticId id;
  std::string_view code; // "D0123"
  std::string_view name; // "unknown_key"
  Severity severity;
  std::string_view hint; // what to do, in general
};

const DiagnosticInfo& diagnostic_info(DiagnosticId id);
std::span<const DiagnosticInfo> all_diagnostic_infos(); // sorted by id

struct Diagnostic {
  DiagnosticId id{};
  SourceLocation where;
  std::string text;       // names the thing, what was expected and what was found
  std::string suggestion; // "did you mean 'size'?", may be empty
  std::vector<std::pair<SourceLocation, std::string>> related; // the other end: "declared here"
};

struct SourceFile {
  std::string name; // as given by the caller, for messages
  std::string text; // kept for excerpts
};

// All that was found in one run, in order of discovery; and the texts they point into. At most
// limits::diagnostics are kept, then one too_many_diagnostics; errors beyond that still count as errors.
struct Diagnostics {
  std::vector<SourceFile> files;
  std::vector<Diagnostic> list;
  uint64_t dropped_errors = 0;
  Diagnostic dropped; // what add() returns once the list is full

  // The new entry, to add a suggestion or related locations to; valid until the next add().
  Diagnostic& add(DiagnosticId id, SourceLocation where, std::string text);
  bool full() const; // nothing more will be listed: readers may stop looking
  bool has_errors() const;
  uint32_t count(Severity severity) const;
};

// "file:line:column: error[D0101 unknown_key]: text", excerpt with caret, hint. No trailing newline.
std::string format_for_people(const Diagnostics& all, const Diagnostic& one, bool excerpt = true);
// The whole list as a JSON array of {id, name, severity, file, line, column, pointer, text, suggestion, hint,
// related}.
std::string format_as_json(const Diagnostics& all);
// The whole list as a SARIF 2.1.0 log of one run. Columns count code points there, paths are URIs.
std::string format_as_sarif(const Diagnostics& all, std::string_view tool_version);

} // namespace dermis
