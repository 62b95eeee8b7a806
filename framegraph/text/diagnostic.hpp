#pragma once
// Defines diagnostics: messages with a stable id that say what is wrong, where, what was expected
// and what to do. Errors are values.

#include "framegraph/text/index.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace dermis {

// Location of a value in its source text. Lines and columns count from 1, columns in bytes.
struct SourceLocation {
  FileId file;                   // into Diagnostics::files; invalid: no file
  uint32_t line = 0, column = 0; // 0: the whole file
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
  std::string_view hint; // general advice
};

const DiagnosticInfo& diagnostic_info(DiagnosticId id);
std::span<const DiagnosticInfo> all_diagnostic_infos(); // sorted by id

struct Diagnostic {
  DiagnosticId id{};
  SourceLocation where;
  std::string text;       // names the object, what was expected and what was found
  std::string suggestion; // "did you mean 'size'?"; may be empty
  // other locations involved: "declared here"
  std::vector<std::pair<SourceLocation, std::string>> related;
};

struct SourceFile {
  std::string name; // as given by the caller, for messages
  std::string text; // kept for excerpts
};

// Holds the diagnostics of one run in order of discovery, and the texts that they refer to. At most
// limits::diagnostics are kept, then one too_many_diagnostics; further errors are still counted.
struct Diagnostics {
  std::vector<SourceFile> files;
  std::vector<Diagnostic> list;
  uint64_t dropped_errors = 0;
  Diagnostic dropped; // returned by add() once the list is full

  // Adds an entry and returns it, to add a suggestion or related locations; valid until the next
  // add().
  Diagnostic& add(DiagnosticId id, SourceLocation where, std::string text);
  // Returns true if nothing more will be listed, so that readers may stop.
  bool full() const;
  bool has_errors() const;
  uint32_t count(Severity severity) const; // in `list`
  // Returns the number of errors so far, including dropped ones. Compare it to learn whether a step
  // reported an error.
  uint64_t errors() const;
};

// Returns "file:line:column: error[D0101 unknown_key]: text", an excerpt with a caret, and the
// hint, without a trailing newline.
std::string format_for_people(const Diagnostics& all, const Diagnostic& one, bool excerpt = true);
// Returns the whole list as a JSON array of {id, name, severity, file, line, column, pointer, text,
// suggestion, hint, related}.
std::string format_as_json(const Diagnostics& all);
// Returns the whole list as a SARIF 2.1.0 log with one run. Its columns count code points, and its
// paths are URIs.
std::string format_as_sarif(const Diagnostics& all, std::string_view tool_version);

} // namespace dermis
