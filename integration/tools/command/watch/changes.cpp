#include "integration/tools/command/watch/changes.hpp"

#include <algorithm>

namespace dermis::tools {
namespace {

std::pair<std::filesystem::file_time_type, uint64_t> state_of(const std::string& file) {
  std::error_code error;
  const auto time = std::filesystem::last_write_time(file, error);
  const uint64_t size = error ? 0 : std::filesystem::file_size(file, error);
  if (error) return {};
  return {time, size};
}

} // namespace

void Changes::add(const std::vector<std::string>& files) {
  for (const std::string& file : files)
    known_.try_emplace(file, state_of(file));
}

std::vector<std::string> Changes::look(const std::vector<std::string>& files) {
  std::vector<std::string> changed;
  for (const std::string& file : files) {
    const State now = state_of(file);
    const auto [at, is_new] = known_.try_emplace(file, now);
    if (!is_new && at->second != now) changed.push_back(file);
    at->second = now;
  }
  return changed;
}

std::vector<std::string> files_below(const std::string& folder,
                                     const std::vector<std::string>& extensions) {
  std::vector<std::string> found;
  std::error_code error;
  for (std::filesystem::recursive_directory_iterator at(folder, error), end; !error && at != end;
       at.increment(error))
    if (std::find(extensions.begin(), extensions.end(), at->path().extension()) != extensions.end())
      found.push_back(at->path().string());
  std::sort(found.begin(), found.end());
  return found;
}

} // namespace dermis::tools
