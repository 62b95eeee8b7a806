#include "integration/tools/command/output.hpp"

#include "integration/tools/files/bytes.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>

namespace dermis::tools {
namespace {

namespace files = std::filesystem;

// Removes `root` and its subfolders where they hold nothing except empty folders.
void remove_if_empty(const files::path& root) {
  std::error_code ignored;
  for (files::directory_iterator entry(root, ignored), end; !ignored && entry != end;
       entry.increment(ignored))
    if (entry->is_directory(ignored) && !entry->is_symlink(ignored)) remove_if_empty(entry->path());
  files::remove(root, ignored); // fails if the folder is not empty
}

} // namespace

std::string deliver_text(const std::string& path, std::string_view text) {
  std::string problem;
  if (path != "-") {
    write_text(path, text, problem);
    return problem;
  }
  errno = 0;
  const bool written =
      std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  return written ? "" : fmt::format("cannot write to standard output: {}", std::strerror(errno));
}

std::string deliver_page(const std::string& path, std::string_view text) {
  const files::path folder = files::path(path).parent_path();
  std::error_code problem;
  if (path != "-" && !folder.empty()) files::create_directories(folder, problem);
  if (problem)
    return fmt::format("cannot make the folder '{}': {}", folder.string(), problem.message());
  return deliver_text(path, text);
}

OutputFolder::~OutputFolder() {
  if (!first_made_.empty()) remove_if_empty(first_made_);
}

std::string OutputFolder::open(const std::string& path) {
  if (path == "-") return "'-' is standard output; pictures need a folder (./- for this name)";
  path_ = path;
  std::error_code problem;
  files::path outermost = files::absolute(path, problem).lexically_normal();
  for (files::path at = outermost;
       !problem && !files::exists(at, problem) && at.has_relative_path(); at = at.parent_path())
    outermost = at;
  const bool made = files::create_directories(path, problem);
  if (problem)
    return fmt::format("cannot make the output folder '{}': {}", path, problem.message());
  if (made) first_made_ = outermost.string();
  const files::path probe = temporary_path(path_of("probe"));
  std::string rejected;
  if (!write_text(probe, "", rejected))
    return fmt::format("cannot write into the output folder '{}': {}", path, rejected);
  files::remove(probe, problem);
  return "";
}

std::string OutputFolder::open_for(const std::string& file) {
  std::error_code ignored;
  if (file == "-" || (files::exists(file, ignored) && files::is_other(file, ignored))) return "";
  const files::path parent = files::path(file).parent_path();
  return open(parent.empty() ? "." : parent.string());
}

std::string OutputFolder::open_below(const std::string& name) {
  std::error_code problem;
  files::create_directories(path_of(name), problem);
  return problem ? fmt::format("cannot make the output folder '{}': {}", path_of(name),
                               problem.message())
                 : "";
}

std::string OutputFolder::path_of(std::string_view name) const {
  return (files::path(path_) / name).string();
}

void OutputFolder::remove(std::string_view name) const {
  std::error_code ignored; // a file that stays is one that cannot be written either
  files::remove(path_of(name), ignored);
}

} // namespace dermis::tools
