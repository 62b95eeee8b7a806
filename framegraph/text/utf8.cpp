#include "framegraph/text/utf8.hpp"

#include <cstdint>
#include <fmt/format.h>
#include <iterator>

namespace dermis {
namespace {

// Returns the code point of a valid sequence.
uint32_t code_point(std::string_view sequence) {
  const auto lead = static_cast<uint8_t>(sequence[0]);
  const size_t length = sequence.size();
  uint32_t code = length == 1 ? lead : lead & (0x7fu >> length);
  for (size_t i = 1; i < length; ++i)
    code = code << 6 | (static_cast<uint8_t>(sequence[i]) & 0x3fu);
  return code;
}

} // namespace

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

bool acts_on_terminal(std::string_view sequence) {
  const uint32_t code = code_point(sequence);
  const auto within = [&](uint32_t first, uint32_t last) { return code >= first && code <= last; };
  return code < 0x20 || within(0x7f, 0x9f) ||                // control characters
         within(0x200e, 0x200f) || within(0x2028, 0x202e) || // direction of text, new lines
         within(0x2066, 0x2069) || code == 0xfeff;
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
    } else if (const std::string_view one = text.substr(at, length); acts_on_terminal(one)) {
      if (length == 1)
        fmt::format_to(std::back_inserter(out), "\\x{:02x}", code_point(one));
      else
        fmt::format_to(std::back_inserter(out), "\\u{:04x}", code_point(one));
      at += length;
    } else {
      out += text.substr(at, length);
      at += length;
    }
  }
}

} // namespace dermis
