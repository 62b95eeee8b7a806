#pragma once
// Options common to all verbs, and reporting of failures.

#include "framegraph/text/diagnostic.hpp"
#include "integration/examples/demo_engine/result.hpp"
#include "integration/tools/command/exit_code.hpp"
#include "integration/tools/command/present.hpp"

#include <string>
#include <string_view>

namespace dermis::tools {

struct Session {
  bool json = false;  // one JSON document on stdout instead of text
  bool quiet = false; // errors only
  ColorMode color = ColorMode::automatic;
  std::string command; // command line of the program, for reports
};

// Reports the problem and the remedy, on stderr as text or on stdout as JSON, and returns `code`.
// `diagnostics` (may be null) are printed first.
ExitCode fail(const Session& session, ExitCode code, std::string_view message,
              const Diagnostics* diagnostics = nullptr);
// Returns the exit code of the error's kind.
ExitCode fail(const Session& session, const demo::Error& error,
              const Diagnostics* diagnostics = nullptr);

// Prints all diagnostics on stderr; prints nothing with --json, and only errors with --quiet.
void print_diagnostics(const Session& session, const Diagnostics& diagnostics);

// Prints text on stdout; prints nothing with --json or --quiet.
void say(const Session& session, std::string_view text);

// Returns text for a terminal: lines as they are, other control characters as \xNN.
std::string for_terminal(std::string_view text);

// Prints machine-readable text on stdout.
void print(std::string_view text);
// Returns whether some text could not be written to stdout.
bool is_output_lost();

// Prints text on stderr. Ignores failures: work goes on if nobody can read its messages.
void print_message(std::string_view text);

// Prints all diagnostics on stderr, also with --json, for verbs whose JSON document does not
// contain them; only errors with --quiet.
void print_beside_document(const Session& session, const Diagnostics& diagnostics);

} // namespace dermis::tools
