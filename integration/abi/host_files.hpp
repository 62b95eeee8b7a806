#pragma once
// Reads files that the host delivers by name.

#include "framegraph/compose/compose.hpp"
#include "integration/include/dermis/dermis.h"

namespace dermis::abi {

// Returns a copy of the host's file. FileText::problem says if the host has no such file or no
// include function.
FileText ask_host(dermis_include_fn include, void* user, std::string_view name);

} // namespace dermis::abi
