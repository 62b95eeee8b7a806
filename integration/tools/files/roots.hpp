#pragma once
// Opens files that other files name. Only files below declared folders are readable.

#include "framegraph/compose/compose.hpp"

#include <filesystem>
#include <vector>

namespace dermis::tools {

// Opens a name in the first of `roots` that holds a regular file of that name. Paths and links that
// lead out of that folder are rejected (place_file). Thread: any.
OpenFile open_below(std::vector<std::filesystem::path> roots);

} // namespace dermis::tools
