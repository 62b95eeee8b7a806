#pragma once
// Detects changed files by time and size.

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace dermis::tools {

class Changes {
public:
  // Records the present state of those `files` that are not known yet.
  void add(const std::vector<std::string>& files);
  // Returns the `files` that changed, appeared or disappeared since the last call, and records
  // their present state. Unknown files count as unchanged.
  std::vector<std::string> look(const std::vector<std::string>& files);

private:
  // zeros if the file does not exist
  using State = std::pair<std::filesystem::file_time_type, uint64_t>;
  std::map<std::string, State> known_;
};

// Returns the files below a folder whose names end in one of `extensions`, sorted.
std::vector<std::string> files_below(const std::string& folder,
                                     const std::vector<std::string>& extensions);

} // namespace dermis::tools
