#pragma once
// The page that `dermis graph --html` writes, built from src/ and the packages of
// package-lock.json. The build needs Node.

#include <span>
#include <string_view>

namespace dermis::tools {

// The page's text before and after its data (base64 of a zlib stream of JSON). A non-empty
// `missing` is the reason why the program was built without the page.
struct ViewerPage {
  std::span<const std::string_view> before, after;
  std::string_view missing;
};
ViewerPage viewer_page();

} // namespace dermis::tools
