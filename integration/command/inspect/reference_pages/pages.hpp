#pragma once
// Pages of documentation that follow from declarations, as Markdown.

#include "framegraph/model/pass_kind.hpp"

#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace dermis::tools {

// A text inside a table.
inline std::string cell(std::string_view text) {
  std::string out;
  for (const char c : text)
    out += c == '|' ? std::string("\\|") : c == '\n' ? std::string(" ") : std::string(1, c);
  return out;
}

// Tables of the keys of each schema (name, text), in this order.
std::string format_page(std::span<const std::pair<std::string_view, std::string>> schemas);

// Ports and settings of each kind.
std::string kinds_page(const KindRegistry& kinds);

} // namespace dermis::tools
