#pragma once
// What every verb shares: the common options, and how a verb says that it failed.

#include "framegraph/text/diagnostic.hpp"
#include "integration/tools/command/exit_code.hpp"
#include "integration/tools/command/present.hpp"

#include <string>
#include <string_view>

namespace dermis::tools {

struct Session {
  bool json = false;  // one JSON document on stdout instead of text
  bool quiet = false; // errors only
  ColorMode color = ColorMode::automatic;
  std::string command; // line that the program was called with, for reports
};

// Says what went wrong and what to do, for people on stderr or for programs on stdout; returns `code`.
// `diagnostics` (may be null) are printed before.
ExitCode fail(const Session& session, ExitCode code, std::string_view message,
              const Diagnostics* diagnostics = nullptr);

// All diagnostics for people on stderr; nothing with --json. With --quiet only errors.
void print_diagnostics(const Session& session, const Diagnostics& diagnostics);

// Text for people on stdout; nothing with --json or --quiet.
void say(const Session& session, std::string_view text);

// Text for programs on stdout.
void print(std::string_view text);

} // namespace dermis::tools
