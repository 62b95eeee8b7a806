#pragma once
// What the command line declares, as plain data: for completion scripts and the manual page. Internal to
// arguments/.

#include "integration/tools/command/arguments/arguments.hpp"

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace dermis::tools {

struct DeclaredOption {
  std::vector<std::string> names;   // "--out", "-o"; of a positional its one name
  std::string text;                 // what it does
  std::string type;                 // "FILE"; "": takes no value
  std::vector<std::string> values;  // of which it takes one; empty: any
  std::vector<std::string> offered; // some that it takes
  bool positional = false, required = false;
};

struct DeclaredVerb {
  std::string name; // "bench all"; "": the program itself
  std::string text;
  std::vector<std::string> examples; // lines
  std::vector<DeclaredOption> options;
  std::vector<std::string> verbs; // last words of those below; none can be run by itself where there are some
};

// The program, then each verb followed by those below it, in the order of their declaration.
std::vector<DeclaredVerb> declared_verbs(CLI::App& app, const OfferedWords& offered);

// For the shells "bash", "zsh" and "fish"; "" for another one.
std::string completion_script(const std::vector<DeclaredVerb>& verbs, std::string_view shell);

// dermis(1) for man.
std::string manual_page(const std::vector<DeclaredVerb>& verbs, std::string_view version);

} // namespace dermis::tools
