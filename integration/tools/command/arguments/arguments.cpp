#include "integration/tools/command/arguments/arguments.hpp"

#include "framegraph/text/suggest.hpp"
#include "integration/tools/command/arguments/add_verb.hpp"
#include "integration/tools/command/arguments/lost_files.hpp"
#include "integration/tools/command/arguments/usage_error.hpp"

#include <CLI/CLI.hpp>
#include <dermis/dermis.h>
#include <fmt/format.h>

#include <algorithm>

namespace dermis::tools {
namespace {

std::string_view name_part(std::string_view argument) {
  return argument.substr(0, argument.find('='));
}

std::vector<CLI::App*> subcommands(CLI::App& app) {
  return app.get_subcommands([](CLI::App*) { return true; });
}

std::string list_subcommands(CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* one : subcommands(app))
    names.push_back(one->get_name());
  return list_words(std::vector<std::string_view>(names.begin(), names.end()));
}

// Returns the subcommand of that name. Returns null and sets `problem` if there is none. `verb` is
// the verb that has the subcommands; "": the program.
CLI::App* find_subcommand(CLI::App& app, const std::string& name, std::string_view verb,
                          std::string& problem) {
  std::vector<std::string> names;
  for (CLI::App* one : subcommands(app)) {
    if (one->get_name() == name) return one;
    names.push_back(one->get_name());
  }
  const std::string suggestion =
      did_you_mean(name, std::vector<std::string_view>(names.begin(), names.end()));
  problem = fmt::format("{} '{}'; {}",
                        verb.empty() ? "there is no verb" : fmt::format("'{}' has no verb", verb),
                        name, suggestion.empty() ? "verbs: " + list_subcommands(app) : suggestion);
  return nullptr;
}

// Returns whether the value of an option that takes a list has nothing between two separators.
// CLI11 ignores such entries, and without any other takes the next argument as the value.
bool has_empty_entry(const CLI::Option& option, std::string_view list) {
  const char separator = option.get_delimiter();
  return separator != '\0' && !list.empty() &&
         (list.front() == separator || list.back() == separator ||
          list.find(std::string(2, separator)) != std::string_view::npos);
}

// Returns whether the argument names an option of the verb. "--" and "-" name none.
bool is_option(const CLI::App& verb, std::string_view argument) {
  const bool is_short = argument.size() == 2 && argument[0] == '-' && argument[1] != '-';
  return (is_short || (argument.starts_with("--") && argument.size() > 2)) &&
         verb.get_option_no_throw(std::string(name_part(argument))) != nullptr;
}

// Returns the problem if an option without its value precedes another option. CLI11 takes the name
// of the latter as the value.
std::string find_missing_value(const CLI::App& verb, std::string_view name,
                               std::string_view following) {
  const CLI::Option* option = verb.get_option_no_throw(std::string(name));
  if (option == nullptr || option->get_expected_max() == 0 || !is_option(verb, following))
    return "";
  return fmt::format("{0}: the value is missing; '{1}' is an option. Use '{2}={1}' for this value",
                     name, following, option->get_name());
}

// Reports a missing verb, a misspelt verb or option, and an empty entry of a list before CLI11
// reports missing options. Returns "" if all are known.
std::string find_misspelling(CLI::App& app, int argc, const char* const* argv) {
  if (argc < 2) return "a verb is required; 'dermis --help' lists all verbs";
  if (std::string_view(argv[1]).starts_with("-")) return "";
  std::string problem;
  CLI::App* verb = find_subcommand(app, argv[1], "", problem);
  if (verb == nullptr) return problem;
  int options_from = 2;
  std::string verb_words = argv[1];
  const bool has_inner = !subcommands(*verb).empty();
  if (argc == 2 && has_inner)
    return fmt::format("'{}' requires a verb: {}; 'dermis {} --help' describes them", argv[1],
                       list_subcommands(*verb), argv[1]);
  if (argc > 2 && has_inner && !std::string_view(argv[2]).starts_with("-")) {
    verb = find_subcommand(*verb, argv[2], argv[1], problem);
    if (verb == nullptr) return problem;
    options_from = 3;
    verb_words += fmt::format(" {}", argv[2]);
  }
  for (int i = options_from; i < argc && std::string_view(argv[i]) != "--"; ++i) {
    const std::string name(name_part(argv[i]));
    if (is_option(*verb, argv[i]) && name == argv[i] && i + 1 < argc)
      if (problem = find_missing_value(*verb, name, argv[i + 1]); !problem.empty()) return problem;
    if (!name.starts_with("--")) continue;
    if (const CLI::Option* option = verb->get_option_no_throw(name)) {
      const std::string_view argument(argv[i]);
      const std::string_view list = name.size() < argument.size() ? argument.substr(name.size() + 1)
                                    : i + 1 < argc                ? std::string_view(argv[i + 1])
                                                                  : std::string_view();
      if (has_empty_entry(*option, list))
        return fmt::format("{}: the list '{}' has an empty entry", name, list);
      continue;
    }
    std::vector<std::string> names;
    for (const CLI::Option* one : verb->get_options())
      names.insert(names.end(), one->get_lnames().begin(), one->get_lnames().end());
    // Without the dashes, which are equal in all and would make short names similar.
    const std::string_view best =
        nearest(name.substr(2), std::vector<std::string_view>(names.begin(), names.end()));
    return fmt::format("'{}' has no option '{}'; {}", verb_words, name,
                       best.empty() ? fmt::format("'dermis {} --help' lists them", verb_words)
                                    : fmt::format("did you mean '--{}'?", best));
  }
  return "";
}

// Returns the words that name the verb, such as "bench all".
std::string verb_of(const CLI::App& app) {
  std::string words;
  for (const CLI::App* at = &app; at != nullptr;) {
    const std::vector<const CLI::App*> parsed =
        at->get_subcommands([](const CLI::App* one) { return one->parsed(); });
    at = parsed.empty() ? nullptr : parsed.front();
    if (at != nullptr) words += (words.empty() ? "" : " ") + at->get_name();
  }
  return words;
}

// Returns the first option of the verb that was given an empty value, as from an unset variable of
// a shell; "" if there is none. --cache '' means no cache.
std::string find_empty_value(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options()) {
    const std::vector<std::string>& values = option->results();
    if (option->get_name() != "--cache" && option->get_expected_max() > 0 &&
        std::find(values.begin(), values.end(), "") != values.end())
      return option->get_name();
  }
  for (const CLI::App* inner : app.get_subcommands())
    if (std::string found = find_empty_value(*inner); !found.empty()) return found;
  return "";
}

} // namespace

Invocation read_arguments(int argc, const char* const* argv) {
  Invocation invocation;
  CLI::App app("Frame graphs for subsurface scattering.\n", "dermis");
  app.require_subcommand(1);
  app.set_version_flag("--version", fmt::format("dermis {}.{}.{}", DERMIS_VERSION_MAJOR,
                                                DERMIS_VERSION_MINOR, DERMIS_VERSION_PATCH));
  app.footer(
      "Example:\n"
      "  dermis render configs/scenes/bust.json --graph configs/graphs/sap.json --out out/\n\n"
      "Exit codes: 0 success; 1 the input has problems; 2 bad option or value; 3 no driver,\n"
      "unwritable output or missing package; 4 a defect of the program; 130 stopped by Ctrl-C;\n"
      "141 the reader of standard output ended first, such as head.");
  add_text_verbs(app, invocation);
  add_plan_verbs(app, invocation);
  add_schema_verb(app, invocation);
  add_docs_verb(app, invocation);
  add_kernels_verb(app, invocation);
  add_doctor_verb(app, invocation);
  add_picture_verbs(app, invocation);
  add_bench_verbs(app, invocation);
  add_shell_verbs(app, invocation);

  for (int i = 0; i < argc; ++i)
    invocation.session.command += (i == 0 ? "" : " ") + std::string(argv[i]);

  // Usage errors are also reported as JSON if --json is given.
  invocation.session.json = std::count(argv, argv + argc, std::string_view("--json")) > 0;
  invocation.message = find_misspelling(app, argc, argv);
  if (!invocation.message.empty()) return invocation;
  try {
    app.parse(argc, argv);
    if (const std::string option = find_empty_value(app); !option.empty()) {
      invocation.message = fmt::format("{}: the value is empty; 'dermis {} --help' describes it",
                                       option, verb_of(app));
      invocation.run = nullptr;
    } else {
      const std::string verb = verb_of(app);
      invocation.message = find_lost_file(app, verb);
      if (invocation.message.empty()) invocation.message = find_foreign_file(app, verb);
      if (!invocation.message.empty()) invocation.run = nullptr;
    }
  } catch (const CLI::CallForHelp&) {
    invocation.help = app.help(); // of the selected verb, with its full name
  } catch (const CLI::CallForVersion& version) {
    invocation.help = std::string(version.what()) + "\n";
  } catch (const CLI::ParseError& error) {
    invocation.message = reword_usage_error(error.what(), verb_of(app));
    invocation.run = nullptr;
  }
  return invocation;
}

} // namespace dermis::tools
