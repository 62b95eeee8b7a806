#pragma once
// Checks UTF-8 according to RFC 3629: no overlong forms, no surrogates, nothing above U+10FFFF.

#include <cstddef>
#include <string>
#include <string_view>

namespace dermis {

// Returns the offset of the first byte that does not continue well-formed UTF-8;
// std::string_view::npos if there is none.
size_t find_invalid_utf8(std::string_view text);

// Returns the number of bytes of the well-formed sequence at the start of `text`; 0 if there is
// none or `text` is empty.
size_t utf8_sequence_bytes(std::string_view text);

// Returns whether a well-formed sequence, which is not empty, is a control character, begins a new
// line or changes the direction of text.
bool acts_on_terminal(std::string_view sequence);

// Appends `text` made safe for a terminal or a log: what acts_on_terminal() finds becomes \xNN or
// \uNNNN, ill-formed bytes '?'. Keeps at most `max_bytes` of the input, cut between code points,
// and marks a cut with
// "...".
void append_printable(std::string& out, std::string_view text, size_t max_bytes);
inline constexpr size_t longest_text = 4096; // bytes of a message, name or pointer
// Returns the first 80 bytes of a token or value, made safe for messages.
std::string shown_token(std::string_view text);

} // namespace dermis
