#pragma once
// UTF-8 as RFC 3629 has it: no overlong forms, no surrogates, nothing above U+10FFFF.

#include <cstddef>
#include <string>
#include <string_view>

namespace dermis {

// Offset of the first byte that does not continue well-formed UTF-8; std::string_view::npos when all is well.
size_t find_invalid_utf8(std::string_view text);

// Bytes of the well-formed sequence at the start of `text`; 0 when there is none or `text` is empty.
size_t utf8_sequence_bytes(std::string_view text);

// `text` made safe for a terminal or a log: control characters become \xNN, ill-formed bytes '?'. At most
// `max_bytes` of the input are kept, cut between code points, with "..." in place of the rest.
void append_printable(std::string& out, std::string_view text, size_t max_bytes);
inline constexpr size_t longest_text = 4096; // bytes of a message, name or pointer
// A token or value as messages show it: the first 80 bytes, made safe.
std::string shown_token(std::string_view text);

} // namespace dermis
