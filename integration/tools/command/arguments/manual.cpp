// Formats the manual page with the macros of man(7).
#include "integration/tools/command/arguments/declared.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace dermis::tools {
namespace {

// Escapes text for roff: no macro at the start of a line, no escapes, hyphens that are not typeset.
std::string roff(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if ((out.empty() || out.back() == '\n') && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
  }
  return out;
}

std::string synopsis(const DeclaredVerb& verb) {
  std::string line = fmt::format(".B dermis {}\n", roff(verb.name));
  for (const DeclaredOption& option : verb.options)
    if (option.positional || option.required) {
      const std::string text =
          option.positional ? option.names.front() : option.names.front() + " " + option.type;
      line += option.required ? roff(text) + "\n" : fmt::format("[{}]\n", roff(text));
    }
  return line + "[options]\n";
}

void add_option(std::string& page, const DeclaredOption& option) {
  std::string names;
  for (const std::string& name : option.names)
    names += fmt::format("{}\\fB{}\\fR", names.empty() ? "" : ", ", roff(name));
  page += fmt::format(".TP\n{}{}\n{}\n", names,
                      option.type.empty() ? "" : fmt::format(" \\fI{}\\fR", roff(option.type)),
                      roff(option.text));
  const auto reported = [&](const std::string& value) {
    return option.text.find(value) != std::string::npos;
  };
  if (std::all_of(option.values.begin(), option.values.end(), reported)) return;
  page += "One of";
  for (const std::string& value : option.values)
    page += " " + roff(value);
  page += ".\n";
}

} // namespace

std::string manual_page(const std::vector<DeclaredVerb>& verbs, std::string_view version) {
  std::string page = fmt::format(
      ".\\\" Made by: dermis man\n.TH DERMIS 1 \"\" \"dermis {}\" \"Dermis\"\n.SH NAME\n"
      "dermis \\- {}\n.SH SYNOPSIS\n.B dermis\nverb [options]\n.SH DESCRIPTION\n"
      "{}\nEach verb explains itself with \\fB\\-\\-help\\fR.\n.SH VERBS\n",
      version, "frame graphs for subsurface scattering", roff(verbs.front().text));
  for (const DeclaredVerb& verb : verbs) {
    if (verb.name.empty() || !verb.verbs.empty()) continue;
    page +=
        fmt::format(".SS \"{}\"\n{}.PP\n{}.\n", roff(verb.name), synopsis(verb), roff(verb.text));
    for (const DeclaredOption& option : verb.options)
      add_option(page, option);
    if (!verb.examples.empty()) page += ".PP\nExample:\n.PP\n.nf\n";
    for (const std::string& line : verb.examples)
      page += "    " + roff(line) + "\n";
    if (!verb.examples.empty()) page += ".fi\n";
  }
  page += ".SH EXIT STATUS\n"
          ".TP\n0\nDone.\n"
          ".TP\n1\nThe input has problems: a file, the graph, the data.\n"
          ".TP\n2\nA bad option or value.\n"
          ".TP\n3\nNo driver, output that cannot be written, or a missing package.\n"
          ".TP\n4\nA defect of the program.\n"
          ".TP\n130\nStopped by Ctrl-C.\n"
          ".TP\n141\nThe reader of standard output ended first, such as head.\n"
          ".SH ENVIRONMENT\n"
          ".TP\n\\fBNO_COLOR\\fR\n"
          "If set, output has no colour unless \\fB--color always\\fR is given.\n";
  return page;
}

} // namespace dermis::tools
