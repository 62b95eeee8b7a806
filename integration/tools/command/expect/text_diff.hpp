#pragma once
// What changed between two texts, line by line.

#include <string>
#include <string_view>

namespace dermis::tools {

// All lines of both, those only in `before` with "- " in front, those only in `after` with "+ ", the common
// ones with "  "; as few marked lines as possible, unless both texts differ over more than 4096 lines, which
// are then all marked.
std::string diff_lines(std::string_view before, std::string_view after);

} // namespace dermis::tools
