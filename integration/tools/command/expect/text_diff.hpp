#pragma once
// Compares two texts line by line.

#include <string>
#include <string_view>

namespace dermis::tools {

// Returns the lines of both texts: lines only in `before` prefixed with "- ", lines only in `after`
// with "+ ", common lines with "  ". The number of marked lines is minimal, unless the texts differ
// over more than 4096 lines, which are then all marked.
std::string diff_lines(std::string_view before, std::string_view after);

} // namespace dermis::tools
