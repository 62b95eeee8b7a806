#pragma once
// Returns docs/diagnostics.md, which is embedded in the command.

#include <string_view>

namespace dermis::tools {

std::string_view diagnostics_page();

// Returns the entry of a code ("D0103") without its heading, or "" if there is none.
std::string_view diagnostic_paragraph(std::string_view code);

} // namespace dermis::tools
