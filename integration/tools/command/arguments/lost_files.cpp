#include "integration/tools/command/arguments/lost_files.hpp"

#include "integration/tools/command/bench/suite/suites.hpp"
#include "integration/tools/command/output_kind.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <vector>

namespace dermis::tools {
namespace {

namespace fs = std::filesystem;

constexpr std::array outputs{"out",   "capture", "trace", "heat", "flip-map", "html",
                             "sarif", "junit",   "json",  "csv",  "assembly", "write-captures"};

struct Path {
  const CLI::Option* option;
  std::string text;
  fs::path absolute; // without symbolic links
};

bool is_output(const CLI::Option& option) {
  return std::ranges::any_of(outputs, [&](const char* name) { return option.check_lname(name); });
}

// Adds the values of all options and arguments that can be paths.
void collect(const CLI::App& app, std::vector<Path>& found) {
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_expected_max() == 0) continue; // a flag
    for (const std::string& text : option->results()) {
      std::error_code ignored;
      const fs::path path = fs::weakly_canonical(fs::absolute(text, ignored), ignored);
      if (!path.empty())
        found.push_back({option, text, path.has_filename() ? path : path.parent_path()});
    }
  }
  for (const CLI::App* inner : app.get_subcommands())
    collect(*inner, found);
}

bool is_within(const fs::path& path, const fs::path& folder) {
  const auto [at, other] = std::mismatch(folder.begin(), folder.end(), path.begin(), path.end());
  return at == folder.end();
}

bool same_file(const fs::path& a, const fs::path& b) {
  std::error_code ignored;
  return a == b || fs::equivalent(a, b, ignored);
}

// Returns whether the verb writes a file of this path into the folder.
bool is_written_into(const Path& folder, const Path& file, std::string_view verb) {
  return folder.option->check_lname("out") && is_within(file.absolute, folder.absolute) &&
         is_name_of_output(verb,
                           file.absolute.lexically_relative(folder.absolute).generic_string());
}

// Returns whether writing one output destroys the other. A capture replaces its folder.
bool overlap(const Path& a, const Path& b, std::string_view verb) {
  if (is_written_into(a, b, verb) || is_written_into(b, a, verb)) return true;
  const bool folders = (a.option->check_lname("out") && b.option->check_lname("capture")) ||
                       (a.option->check_lname("capture") && b.option->check_lname("out"));
  return same_file(a.absolute, b.absolute) ||
         (folders && (is_within(a.absolute, b.absolute) || is_within(b.absolute, a.absolute)));
}

// Returns the problem if the output is written over the input: the input's file, a file of its name
// in the output's folder, or an image in a folder of images that are compared. Else returns "".
std::string replaced_input(const Path& output, const Path& input, std::string_view verb) {
  std::error_code ignored;
  const std::string name = output.option->get_name();
  if (fs::is_directory(input.absolute, ignored))
    return verb == "compare" && input.option->get_positional() &&
                   is_within(output.absolute, input.absolute) &&
                   fs::exists(output.absolute, ignored)
               ? fmt::format("{}: '{}' is among the inputs of this command; choose another file",
                             name, output.text)
               : "";
  if (!fs::is_regular_file(input.absolute, ignored)) return "";
  if (same_file(input.absolute, output.absolute))
    return fmt::format("{}: '{}' is an input of this command; choose another file", name,
                       output.text);
  if (is_written_into(output, input, verb))
    return fmt::format("{}: this command writes a file named like its input '{}'; choose another "
                       "folder",
                       name, input.text);
  return "";
}

// Checks the files of each suite in the folder of `bench all`, and the rows of one suite as CSV.
std::string check_suites(std::string_view verb, std::string_view option, const fs::path& path) {
  for (const Suite& suite : bench_suites()) {
    const std::string& first_column = suite.columns.front().key;
    if (option == "csv" && verb == "bench " + suite.name)
      return check_csv(option, path.string(), first_column);
    if (verb != "bench all" || option != "out") continue;
    for (const std::string_view extension : {".csv", ".json", ".html"}) {
      const std::string file = fmt::format("{}{}", (path / suite.name).string(), extension);
      std::error_code ignored;
      if (!fs::is_regular_file(file, ignored)) continue; // the suite reports it
      std::string problem =
          extension == ".csv"
              ? check_csv(option, file, first_column)
              : check_output(fmt::format("bench all SUITE{}", extension), option, file);
      if (!problem.empty()) return problem;
    }
  }
  return "";
}

} // namespace

std::string find_lost_file(const CLI::App& app, std::string_view verb) {
  std::vector<Path> paths;
  collect(app, paths);
  const Path* to_stdout = nullptr;
  for (const Path& output : paths) {
    if (!is_output(*output.option)) continue;
    if (output.text == "-") {
      if (to_stdout != nullptr && to_stdout->option != output.option)
        return fmt::format("{} and {} are both written to standard output; choose a file for one",
                           to_stdout->option->get_name(), output.option->get_name());
      to_stdout = &output;
      continue;
    }
    for (const Path& other : paths) {
      if (other.option == output.option || other.text == "-") continue;
      if (other.option->check_lname("frames") && other.option->get_type_name() == "DIR" &&
          output.option->check_lname("out") && is_within(output.absolute, other.absolute))
        return fmt::format("{}: '{}' is in the capture that this command reads; choose another "
                           "folder",
                           output.option->get_name(), output.text);
      if (is_output(*other.option) && overlap(output, other, verb))
        return fmt::format("{} and {} overlap: '{}' and '{}'; choose different paths",
                           output.option->get_name(), other.option->get_name(), output.text,
                           other.text);
      if (is_output(*other.option)) continue;
      if (std::string problem = replaced_input(output, other, verb); !problem.empty())
        return problem;
    }
  }
  return "";
}

std::string find_foreign_file(const CLI::App& app, std::string_view verb) {
  const CLI::Option* name = verb == "schema" ? app.get_option_no_throw("name") : nullptr;
  const bool one_schema = name != nullptr && name->count() > 0;
  for (const CLI::Option* option : app.get_options()) {
    if (!is_output(*option)) continue;
    const std::string& option_name = option->get_lnames().front();
    for (const std::string& path : option->results()) {
      if (path == "-") continue;
      std::string problem = check_output(one_schema ? "schema NAME" : verb, option_name, path);
      if (problem.empty()) problem = check_suites(verb, option_name, path);
      if (!problem.empty()) return problem;
    }
  }
  for (const CLI::App* inner : app.get_subcommands())
    if (std::string problem = find_foreign_file(*inner, verb); !problem.empty()) return problem;
  return "";
}

} // namespace dermis::tools
