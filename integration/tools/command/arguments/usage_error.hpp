#pragma once
// Rewords errors of CLI11 so that each message says what was expected and what to do.

#include <string>
#include <string_view>

namespace dermis::tools {

// `text` is the message of a CLI::ParseError, `verb` the words before the options, such as "bench
// all". Returns unknown messages unchanged.
std::string reword_usage_error(const std::string& text, std::string_view verb);

} // namespace dermis::tools
