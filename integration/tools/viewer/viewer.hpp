#pragma once
// The page that `dermis graph --html` writes: built from src/ and the packages of package-lock.json, where
// there is Node.

#include <span>
#include <string_view>

namespace dermis::tools {

// What stands before and behind the page's data (base 64 of a zlib stream of JSON). `missing` not empty: this
// program was built without the page, and why.
struct ViewerPage {
  std::span<const std::string_view> before, after;
  std::string_view missing;
};
ViewerPage viewer_page();

} // namespace dermis::tools
