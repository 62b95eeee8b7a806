#pragma once
// Pieces of HTML that reports are made of.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace dermis::tools {

// Text with & < > " ' escaped: for contents and attributes.
std::string html_text(std::string_view text);
// A whole page: the style that all reports share, `body` between its tags, and the script that sorts tables.
std::string html_page(std::string_view title, std::string_view body);
// Base 64 after RFC 4648.
std::string base64(std::span<const uint8_t> bytes);

} // namespace dermis::tools
