#include "integration/tools/command/arguments/lost_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <vector>

namespace dermis::tools {
namespace {

namespace fs = std::filesystem;

constexpr std::array outputs{"out",   "capture", "trace", "heat", "flip-map", "html",
                             "sarif", "junit",   "json",  "csv",  "assembly"};

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
      if (text != "-" && !path.empty())
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

// Returns whether writing one output destroys the other. A capture replaces its folder.
bool overlap(const Path& a, const Path& b) {
  const bool folders = (a.option->check_lname("out") && b.option->check_lname("capture")) ||
                       (a.option->check_lname("capture") && b.option->check_lname("out"));
  return same_file(a.absolute, b.absolute) ||
         (folders && (is_within(a.absolute, b.absolute) || is_within(b.absolute, a.absolute)));
}

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

} // namespace

std::string find_lost_file(const CLI::App& app) {
  std::vector<Path> paths;
  collect(app, paths);
  for (const Path& output : paths) {
    if (!is_output(*output.option)) continue;
    for (const Path& other : paths) {
      if (other.option == output.option) continue;
      if (is_output(*other.option) && overlap(output, other))
        return fmt::format("{} and {} overlap: '{}' and '{}'; choose different paths",
                           output.option->get_name(), other.option->get_name(), output.text,
                           other.text);
      if (!is_output(*other.option) && is_file(other.absolute) &&
          same_file(other.absolute, output.absolute))
        return fmt::format("{}: '{}' is an input of this command; choose another file",
                           output.option->get_name(), output.text);
    }
  }
  return "";
}

} // namespace dermis::tools
