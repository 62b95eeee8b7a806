#pragma once
// The command line's declarations as plain data, for completion scripts and the manual page.
// Internal to arguments/.

#include "integration/tools/command/arguments/arguments.hpp"

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace dermis::tools {

struct DeclaredOption {
  std::vector<std::string> names;   // "--out", "-o"; a positional has one name
  std::string text;                 // description
  std::string type;                 // "FILE"; "" for a flag
  std::vector<std::string> values;  // permitted values; empty: any
  std::vector<std::string> offered; // suggested values
  bool positional = false, required = false;
};

struct DeclaredVerb {
  std::string name; // "bench all"; "" for the program itself
  std::string text;
  std::vector<std::string> examples; // lines
  std::vector<DeclaredOption> options;
  // Last words of the subcommands. A verb with subcommands cannot be run by itself.
  std::vector<std::string> verbs;
};

// Returns the program, then each verb followed by its subcommands, in the order of declaration.
std::vector<DeclaredVerb> declared_verbs(CLI::App& app, const OfferedWords& offered);

// Returns the script for "bash", "zsh" or "fish", or "" for another shell.
std::string completion_script(const std::vector<DeclaredVerb>& verbs, std::string_view shell);

// Returns the source of dermis(1) for man.
std::string manual_page(const std::vector<DeclaredVerb>& verbs, std::string_view version);

} // namespace dermis::tools
