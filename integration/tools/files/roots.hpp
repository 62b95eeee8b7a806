#pragma once
// Files that other files name: read below declared folders, and nowhere else.

#include "framegraph/compose/compose.hpp"

#include <filesystem>
#include <vector>

namespace dermis::tools {

// Opens a name in the first of `roots` that holds a regular file of it. What leads out of that folder is
// refused (place_file). Any thread.
OpenFile open_below(std::vector<std::filesystem::path> roots);

} // namespace dermis::tools
