#pragma once
// Building blocks of HTML reports.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace dermis::tools {

// Escapes & < > " ' for contents and attributes.
std::string html_text(std::string_view text);
// Returns a whole page: the common style, `body`, and the script that sorts tables.
std::string html_page(std::string_view title, std::string_view body);
// Base64 (RFC 4648).
std::string base64(std::span<const uint8_t> bytes);

} // namespace dermis::tools
