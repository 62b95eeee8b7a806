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

// Returns whether the file has a name of the pictures that are written to the folder.
bool is_picture_of(const Path& folder, const Path& file) {
  return folder.option->check_lname("out") && file.absolute.parent_path() == folder.absolute &&
         file.absolute.filename().string().starts_with("frame_");
}

// Returns whether writing one output destroys the other. A capture replaces its folder.
bool overlap(const Path& a, const Path& b) {
  if (is_picture_of(a, b) || is_picture_of(b, a)) return true;
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
