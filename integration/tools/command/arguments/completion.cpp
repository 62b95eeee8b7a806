// Completion scripts for shells.
#include "integration/tools/command/arguments/declared.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace dermis::tools {
namespace {

enum class Takes : uint8_t { nothing, file, folder, value, word };

Takes takes_of(const DeclaredOption& option) {
  if (!option.values.empty()) return Takes::word;
  if (option.type.empty()) return Takes::nothing;
  for (const char* type : {"FILE", "PATH", "A", "B"})
    if (option.type == type) return Takes::file;
  if (option.type == "DIR") return Takes::folder;
  return option.offered.empty() ? Takes::value : Takes::word;
}

// Accepted positional words.
struct Operands {
  std::vector<std::string> words;
  bool files = false;
};

Operands operands_of(const DeclaredVerb& verb) {
  Operands operands;
  for (const DeclaredOption& option : verb.options) {
    if (!option.positional) continue;
    operands.words.insert(operands.words.end(), option.offered.begin(), option.offered.end());
    const Takes takes = takes_of(option);
    operands.files |= takes == Takes::file || takes == Takes::folder;
  }
  return operands;
}

std::string replaced(std::string text, std::string_view from, std::string_view to) {
  for (size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

// Escapes text for single quotes.
std::string in_quotes(const std::string& text) {
  return replaced(text, "'", "'\\''");
}

std::string bash(const std::vector<DeclaredVerb>& verbs) {
  std::string known, values, offers;
  for (const DeclaredVerb& verb : verbs) {
    for (const std::string& below : verb.verbs) {
      const std::string whole = verb.name.empty() ? below : verb.name + " " + below;
      known += fmt::format("      '{}/{}') verb='{}' ;;\n", verb.name, below, whole);
    }
    const Operands operands = operands_of(verb);
    std::vector<std::string> options;
    for (const DeclaredOption& option : verb.options) {
      if (option.positional) continue;
      options.insert(options.end(), option.names.begin(), option.names.end());
      std::string patterns;
      for (const std::string& name : option.names)
        patterns += fmt::format("{}'{}/{}'", patterns.empty() ? "" : " | ", verb.name, name);
      const Takes takes = takes_of(option);
      const std::string reply = takes == Takes::file     ? "-f"
                                : takes == Takes::folder ? "-d"
                                : takes == Takes::word
                                    ? fmt::format("-W '{}'", fmt::join(option.offered, " "))
                                    : "-W ''";
      if (takes != Takes::nothing)
        values +=
            fmt::format("    {}) mapfile -t COMPREPLY < <(compgen {} -- \"$current\"); return ;;\n",
                        patterns, reply);
    }
    offers += fmt::format("    '{}') words='{}' options='{}' files={} ;;\n", verb.name,
                          fmt::join(verb.verbs.empty() ? operands.words : verb.verbs, " "),
                          fmt::join(options, " "), operands.files ? "-f" : "");
  }
  return fmt::format(R"(# Completion of dermis for bash, made by: dermis completion bash
_dermis() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD - 1]}}
  local verb='' words='' options='' files='' i
  for ((i = 1; i < COMP_CWORD; ++i)); do
    case "$verb/${{COMP_WORDS[i]}}" in
{}    esac
  done
  case "$verb/$previous" in
{}  esac
  case "$verb" in
{}  esac
  if [[ $current == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$current")
  else
    mapfile -t COMPREPLY < <(compgen $files -W "$words" -- "$current")
  fi
}}
complete -o filenames -F _dermis dermis
)",
                     known, values, offers);
}

// Escapes text for [...] of _arguments.
std::string zsh_text(const std::string& text) {
  return in_quotes(replaced(replaced(replaced(text, "[", "("), "]", ")"), ":", "\\:"));
}

std::string zsh_action(const DeclaredOption& option) {
  switch (takes_of(option)) {
  case Takes::file:
    return "_files";
  case Takes::folder:
    return "_files -/";
  case Takes::word:
    return fmt::format("({})", fmt::join(option.offered, " "));
  case Takes::nothing:
  case Takes::value:
    break;
  }
  return " ";
}

// Returns the zsh action for positional words.
std::string zsh_operand(const Operands& operands) {
  const std::string words = fmt::format("({})", fmt::join(operands.words, " "));
  if (operands.words.empty()) return operands.files ? "_files" : " ";
  return operands.files ? fmt::format(R"(_alternative "files:file:_files" "words:word:{}")", words)
                        : words;
}

std::string zsh_function(const std::string& verb) {
  return verb.empty() ? "_dermis" : "_dermis_" + replaced(replaced(verb, " ", "_"), "-", "_");
}

std::string zsh(const std::vector<DeclaredVerb>& verbs) {
  std::string text =
      "#compdef dermis\n# Completion of dermis for zsh, made by: dermis completion zsh\n";
  for (const DeclaredVerb& verb : verbs) {
    text += fmt::format("\n{}() {{\n", zsh_function(verb.name));
    std::string specifications;
    for (const DeclaredOption& option : verb.options) {
      if (option.positional) continue;
      for (const std::string& name : option.names) {
        const bool value = takes_of(option) != Takes::nothing;
        specifications +=
            fmt::format(" \\\n    '*{}[{}]{}'", name, zsh_text(option.text),
                        value ? fmt::format(":{}:{}", option.type, zsh_action(option)) : "");
      }
    }
    if (verb.verbs.empty()) {
      text += fmt::format("  _arguments -s{} \\\n    '*:argument:{}'\n}}\n", specifications,
                          zsh_operand(operands_of(verb)));
      continue;
    }
    text += fmt::format(
        "  local state line\n  local -a verbs\n  _arguments -C -s{} \\\n    '1:verb:->verb' "
        "'*::argument:->rest'\n"
        "  case $state in\n    verb)\n      verbs=(",
        specifications);
    std::string calls;
    for (const std::string& below : verb.verbs) {
      const std::string whole = verb.name.empty() ? below : verb.name + " " + below;
      const auto at = std::find_if(verbs.begin(), verbs.end(),
                                   [&](const DeclaredVerb& one) { return one.name == whole; });
      text += fmt::format("\n        '{}:{}'", below, zsh_text(at->text));
      calls += fmt::format("        {}) {} ;;\n", below, zsh_function(whole));
    }
    text += fmt::format(")\n      _describe verb verbs ;;\n    rest)\n      case $line[1] in\n{}   "
                        "   esac ;;\n  esac\n}}\n",
                        calls);
  }
  return text + "\n_dermis \"$@\"\n";
}

// Returns a condition that is true if the preceding words name this verb and no subcommand.
std::string fish_condition(const DeclaredVerb& verb) {
  std::string condition;
  if (verb.name.empty()) return "__fish_use_subcommand";
  for (size_t at = 0; at != std::string::npos;) {
    const size_t end = verb.name.find(' ', at);
    condition += fmt::format("{}__fish_seen_subcommand_from {}", condition.empty() ? "" : "; and ",
                             verb.name.substr(at, end == std::string::npos ? end : end - at));
    at = end == std::string::npos ? end : end + 1;
  }
  if (!verb.verbs.empty())
    condition +=
        fmt::format("; and not __fish_seen_subcommand_from {}", fmt::join(verb.verbs, " "));
  return condition;
}

std::string fish(const std::vector<DeclaredVerb>& verbs) {
  const auto quoted = [](const std::string& text) {
    return replaced(replaced(text, "\\", "\\\\"), "'", "\\'");
  };
  std::string text = "# Completion of dermis for fish, made by: dermis completion fish\n";
  for (const DeclaredVerb& verb : verbs) {
    const std::string condition = fish_condition(verb);
    for (const std::string& below : verb.verbs) {
      const std::string whole = verb.name.empty() ? below : verb.name + " " + below;
      const auto at = std::find_if(verbs.begin(), verbs.end(),
                                   [&](const DeclaredVerb& one) { return one.name == whole; });
      text += fmt::format("complete -c dermis -f -n '{}' -a {} -d '{}'\n", condition, below,
                          quoted(at->text));
    }
    if (const Operands operands = operands_of(verb); !operands.words.empty())
      text += fmt::format("complete -c dermis{} -n '{}' -a '{}'\n", operands.files ? "" : " -f",
                          condition, fmt::join(operands.words, " "));
    for (const DeclaredOption& option : verb.options) {
      if (option.positional) continue;
      std::string names;
      for (const std::string& name : option.names)
        names += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      const Takes takes = takes_of(option);
      const std::string value = takes == Takes::nothing ? ""
                                : takes == Takes::file  ? " -r -F"
                                : takes == Takes::folder
                                    ? " -x -a '(__fish_complete_directories)'"
                                    : fmt::format(" -x -a '{}'", fmt::join(option.offered, " "));
      text += fmt::format("complete -c dermis -n '{}'{}{} -d '{}'\n", condition, names, value,
                          quoted(option.text));
    }
  }
  return text;
}

} // namespace

std::string completion_script(const std::vector<DeclaredVerb>& verbs, std::string_view shell) {
  return shell == "bash"   ? bash(verbs)
         : shell == "zsh"  ? zsh(verbs)
         : shell == "fish" ? fish(verbs)
                           : "";
}

} // namespace dermis::tools
