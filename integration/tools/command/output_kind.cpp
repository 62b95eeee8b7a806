#include "integration/tools/command/output_kind.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <span>
#include <vector>

namespace dermis::tools {
namespace {

namespace fs = std::filesystem;

// A kind of output. The first bytes of such a file contain one of `marks`; a mark with '^' is at
// the beginning.
struct Kind {
  const char* name;
  std::array<const char*, 8> marks;
};

constexpr Kind png{"a PNG image", {"^\x89PNG\r\n\x1a\n"}};
constexpr Kind exr{"an OpenEXR image", {"^\x76\x2f\x31\x01"}};
constexpr Kind plan{"a saved plan", {"^DERMPLAN"}};
constexpr Kind calibration{"a calibration", {"\"dermis_calibration\""}};
constexpr Kind errors{"an error table", {"\"dermis_errors\""}};
constexpr Kind rows{"a report of a bench", {"\"dermis_bench\""}};
constexpr Kind trace{"a trace", {"\"traceEvents\""}};
constexpr Kind sarif{"a SARIF file", {"sarif-2.1.0.json"}};
constexpr Kind junit{"a JUnit file", {"<testsuites name=\"dermis test\""}};
constexpr Kind page{"a page of this command",
                    {"^<!doctype html><html lang=en><meta charset=utf-8><meta name=viewport ",
                     "<title>Frame graph</title>"}};
constexpr Kind graph{"a plan as DOT or JSON", {"^digraph ", "\"dermis_plan\""}};
constexpr Kind explanation{"an explanation of a plan, frame or message",
                           {"^plan of ", "\"dermis_plan\"", "^frame ", " frames ran ", "^D0",
                            "\"id\": \"D0", "\"predicted_rmse\"", "\"transient_bytes\""}};
constexpr Kind schema{"a JSON Schema", {"\"http://json-schema.org/draft"}};
constexpr Kind completion{"a completion script", {"made by: dermis completion"}};
constexpr Kind manual{"a manual page", {"Made by: dermis man"}};
constexpr Kind format_reference{"a page of 'dermis docs'", {"^# Formats, key by key"}};
constexpr Kind pass_types{"a page of 'dermis docs'", {"^# Pass types\n"}};
constexpr Kind slots{"a page of 'dermis docs'", {"^# Slots of the shipped graphs"}};

// A file that a verb writes, by the option that names the file or its folder. `verb` "": every verb
// with this option.
struct Output {
  const char* verb;
  const char* option;
  Kind kind;
  // File in the folder, with '*' for any characters in front of and behind a slash; "": the option
  // names the file itself.
  const char* in_folder = "";
};

constexpr Output outputs[] = {
    {"explain", "out", explanation},
    {"graph", "out", graph},
    {"plan save", "out", plan},
    {"calibrate", "out", calibration},
    {"sheet", "out", png},
    {"completion", "out", completion},
    {"man", "out", manual},
    {"bench error-table", "out", errors},
    {"", "trace", trace},
    {"", "sarif", sarif},
    {"", "junit", junit},
    {"", "html", page},
    {"", "json", rows},
    {"", "heat", png},
    {"", "flip-map", png},
    {"render", "out", png, "frame_*.png"},
    {"render", "out", png, "debug_*.png"},
    {"render", "out", exr, "color_*.exr"},
    {"render", "out", exr, "scattered_*.exr"},
    {"watch", "out", png, "frame_*.png"},
    {"watch", "out", exr, "color_*.exr"},
    {"watch", "out", exr, "scattered_*.exr"},
    {"apply", "out", exr, "*/combined.exr"},
    {"apply", "out", exr, "*/scattered.exr"},
    {"reference", "out", exr, "*/reference.exr"},
    {"reference", "out", exr, "*/mask.exr"},
    {"schema", "out", schema, "*.schema.json"},
    {"schema NAME", "out", schema},
    {"docs", "out", format_reference, "format_reference.md"},
    {"docs", "out", pass_types, "pass_types.md"},
    {"docs", "out", slots, "slots.md"},
    {"bench all", "out", rows, "index.json"},
    {"bench all", "out", page, "index.html"},
    {"bench all SUITE.json", "out", rows},
    {"bench all SUITE.html", "out", page},
};

std::string head_of(const fs::path& path) {
  std::string head(4096, '\0'); // longest notes of a table precede its mark
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<size_t>(file.gcount()));
  return head;
}

bool has_mark(std::string_view head, std::string_view mark) {
  return mark.starts_with('^') ? head.starts_with(mark.substr(1)) : head.find(mark) != head.npos;
}

// Returns whether the file has none of the marks. An empty file and a device have nothing to lose.
bool is_foreign(const fs::path& path, std::span<const char* const> marks) {
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored) || fs::file_size(path, ignored) == 0) return false;
  const std::string head = head_of(path);
  return std::ranges::none_of(
      marks, [&](const char* mark) { return mark != nullptr && has_mark(head, mark); });
}

bool matches(std::string_view pattern, std::string_view name) {
  const size_t star = pattern.find('*');
  if (star == pattern.npos) return pattern == name;
  const std::string_view first = pattern.substr(0, star), last = pattern.substr(star + 1);
  return name.size() >= pattern.size() && name.starts_with(first) && name.ends_with(last) &&
         name.substr(star, name.size() - first.size() - last.size()).find('/') == name.npos;
}

// Returns the files in the folder and in its subfolders.
std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code ignored;
  for (fs::directory_iterator one(folder, ignored), end; !ignored && one != end;
       one.increment(ignored)) {
    std::error_code of_entry;
    files.push_back(one->path());
    if (!one->is_directory(of_entry) || one->is_symlink(of_entry)) continue;
    for (fs::directory_iterator inner(one->path(), of_entry); !of_entry && inner != end;
         inner.increment(of_entry))
      files.push_back(inner->path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::string replaces(std::string_view option, const fs::path& path, std::string_view kind) {
  return fmt::format("--{}: '{}' exists and is not {}; choose another path, or remove the file",
                     option, path.string(), kind);
}

std::string check_file(std::string_view option, const std::string& path,
                       std::span<const char* const> marks, std::string_view kind) {
  std::error_code ignored;
  if (path.ends_with('/') || fs::is_directory(path, ignored))
    return fmt::format("--{}: '{}' is a folder; expected the path of a file", option, path);
  return is_foreign(path, marks) ? replaces(option, path, kind) : "";
}

std::string check_folder(const Output& output, const fs::path& folder) {
  for (const fs::path& file : files_in(folder))
    if (matches(output.in_folder, file.lexically_relative(folder).generic_string()) &&
        is_foreign(file, output.kind.marks))
      return replaces(output.option, file, output.kind.name);
  return "";
}

} // namespace

std::string check_output(std::string_view verb, std::string_view option, const std::string& path) {
  for (const Output& one : outputs) {
    if (option != one.option || (*one.verb != '\0' && verb != one.verb)) continue;
    std::string problem = *one.in_folder != '\0'
                              ? check_folder(one, path)
                              : check_file(option, path, one.kind.marks, one.kind.name);
    if (!problem.empty()) return problem;
  }
  return "";
}

std::string check_csv(std::string_view option, const std::string& path,
                      std::string_view first_column) {
  const std::string mark = fmt::format("^{}", first_column);
  const std::array<const char*, 1> header{mark.c_str()};
  return check_file(option, path, header, "a CSV file of this bench");
}

bool is_name_of_output(std::string_view verb, std::string_view name) {
  return std::ranges::any_of(outputs, [&](const Output& one) {
    return verb == one.verb && *one.in_folder != '\0' && matches(one.in_folder, name);
  });
}

std::string earlier_outputs(std::string_view verb, const std::string& folder,
                            const std::set<std::string>& written) {
  size_t count = 0;
  std::string first;
  for (const fs::path& file : files_in(folder)) {
    const std::string name = file.lexically_relative(folder).generic_string();
    if (!is_name_of_output(verb, name) || written.contains(name)) continue;
    if (count++ == 0) first = name;
  }
  if (count == 0) return "";
  if (count == 1)
    return fmt::format("'{}' in '{}' is of an earlier run; this run did not write it", first,
                       folder);
  return fmt::format("'{}' and {} more in '{}' are of an earlier run; this run did not write them",
                     first, count - 1, folder);
}

} // namespace dermis::tools
