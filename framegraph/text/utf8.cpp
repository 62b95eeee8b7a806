#include "framegraph/text/utf8.hpp"

#include <cstdint>
#include <fmt/format.h>
#include <iterator>

namespace dermis {

size_t utf8_sequence_bytes(std::string_view text) {
  if (text.empty()) return 0;
  const auto byte = [&](size_t i) { return static_cast<uint8_t>(text[i]); };
  const uint8_t lead = byte(0);
  if (lead < 0x80) return 1;
  const size_t length = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
  if (lead < 0xc2 || lead > 0xf4 || text.size() < length) return 0;
  for (size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return 0;
  }
  // RFC 3629 section 4: the second byte is restricted after E0 and F0 (overlong), ED (surrogates)
  // and F4 (range).
  if (lead == 0xe0 && byte(1) < 0xa0) return 0;
  if (lead == 0xed && byte(1) > 0x9f) return 0;
  if (lead == 0xf0 && byte(1) < 0x90) return 0;
  if (lead == 0xf4 && byte(1) > 0x8f) return 0;
  return length;
}

size_t find_invalid_utf8(std::string_view text) {
  size_t at = 0;
  while (at < text.size()) {
    const size_t length = utf8_sequence_bytes(text.substr(at, 4));
    if (length == 0) return at;
    at += length;
  }
  return std::string_view::npos;
}

std::string shown_token(std::string_view text) {
  std::string out;
  append_printable(out, text, 80);
  return out;
}

void append_printable(std::string& out, std::string_view text, size_t max_bytes) {
  size_t at = 0;
  while (at < text.size()) {
    const size_t length = utf8_sequence_bytes(text.substr(at, 4));
    if (at + (length == 0 ? 1 : length) > max_bytes) {
      out += "...";
      return;
    }
    if (length == 0) {
      out += '?';
      ++at;
    } else if (length == 1 && (static_cast<uint8_t>(text[at]) < 0x20 || text[at] == 0x7f)) {
      fmt::format_to(std::back_inserter(out), "\\x{:02x}", static_cast<unsigned>(text[at]));
      ++at;
    } else {
      out += text.substr(at, length);
      at += length;
    }
  }
}

} // namespace dermis
