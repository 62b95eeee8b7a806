#include "integration/tools/command/arguments/declared.hpp"

#include <algorithm>
#include <sstream>

namespace dermis::tools {
namespace {

// Parses "MODE:{always,auto,never}", which is how CLI11 describes IsMember.
std::vector<std::string> values_in(const std::string& type) {
  std::vector<std::string> values;
  const size_t open = type.find('{'), close = type.find('}');
  if (open == std::string::npos || close == std::string::npos || close < open) return values;
  std::stringstream list(type.substr(open + 1, close - open - 1));
  for (std::string one; std::getline(list, one, ',');)
    values.push_back(one);
  return values;
}

DeclaredOption declare(const CLI::Option& option, const OfferedWords& offered) {
  DeclaredOption declared;
  declared.text = option.get_description();
  declared.positional = option.get_positional();
  declared.required = option.get_required();
  if (declared.positional) {
    declared.names = {option.get_single_name()};
  } else {
    for (const std::string& name : option.get_lnames())
      declared.names.push_back("--" + name);
    for (const std::string& name : option.get_snames())
      declared.names.push_back("-" + name);
  }
  if (option.get_items_expected_max() > 0 || declared.positional) {
    const std::string type = option.get_type_name();
    declared.type = type.substr(0, type.find_first_of(": "));
    declared.values = values_in(type);
  }
  const auto words = offered.find(&option);
  declared.offered = words != offered.end() ? words->second : declared.values;
  return declared;
}

// Splits "Example:\n  one\n  two" into its example lines.
std::vector<std::string> examples_in(const std::string& footer) {
  std::vector<std::string> lines;
  std::stringstream text(footer);
  for (std::string line; std::getline(text, line);)
    if (const size_t start = line.find_first_not_of(' '); start > 0 && start != std::string::npos)
      lines.push_back(line.substr(start));
  return lines;
}

void add(std::vector<DeclaredVerb>& all, CLI::App& app, const OfferedWords& offered,
         const std::string& name) {
  DeclaredVerb verb{name, app.get_description(), examples_in(app.get_footer()), {}, {}};
  verb.text.erase(verb.text.find_last_not_of('\n') + 1);
  for (const CLI::Option* option : app.get_options())
    verb.options.push_back(declare(*option, offered));
  const std::vector<CLI::App*> below = app.get_subcommands([](CLI::App*) { return true; });
  for (const CLI::App* one : below)
    verb.verbs.push_back(one->get_name());
  all.push_back(std::move(verb));
  for (CLI::App* one : below)
    add(all, *one, offered, name.empty() ? one->get_name() : name + " " + one->get_name());
}

} // namespace

std::vector<DeclaredVerb> declared_verbs(CLI::App& app, const OfferedWords& offered) {
  std::vector<DeclaredVerb> all;
  add(all, app, offered, "");
  return all;
}

} // namespace dermis::tools
