#pragma once
// Which files have changed, by their time and size.

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace dermis::tools {

class Changes {
public:
  // Remembers those of `files` that are not known yet as they are now.
  void add(const std::vector<std::string>& files);
  // Those of `files` that are others than when they were last looked at, come or gone; all are remembered as
  // they are now. What was not known counts as unchanged.
  std::vector<std::string> look(const std::vector<std::string>& files);

private:
  using State = std::pair<std::filesystem::file_time_type, uint64_t>; // of a file that is not there: zeros
  std::map<std::string, State> known_;
};

// Files below a folder whose names end in one of `extensions`, sorted.
std::vector<std::string> files_below(const std::string& folder, const std::vector<std::string>& extensions);

} // namespace dermis::tools
