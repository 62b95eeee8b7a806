#include "integration/tools/command/inspect/diagnostics_page.hpp"

#include <algorithm>
#include <string>

namespace dermis::tools {

std::string_view diagnostic_paragraph(std::string_view code) {
  const std::string_view page = diagnostics_page();
  const size_t heading = page.find("\n### " + std::string(code) + " ");
  if (heading == std::string_view::npos) return "";
  const size_t begin = page.find_first_not_of('\n', page.find('\n', heading + 1));
  const size_t end = std::min(page.find("\n## ", begin), page.find("\n### ", begin));
  std::string_view text = page.substr(begin, end == std::string_view::npos ? end : end - begin);
  text.remove_suffix(text.size() - 1 - text.find_last_not_of('\n'));
  return text;
}

} // namespace dermis::tools
