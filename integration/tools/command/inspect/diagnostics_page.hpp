#pragma once
// docs/diagnostics.md, which travels inside the command.

#include <string_view>

namespace dermis::tools {

std::string_view diagnostics_page();

// What it says of a code ("D0103"), without the heading; "" where it has no such entry.
std::string_view diagnostic_paragraph(std::string_view code);

} // namespace dermis::tools
