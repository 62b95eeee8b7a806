#pragma once
// Files that the host delivers by name.

#include "framegraph/compose/compose.hpp"
#include "integration/include/dermis/dermis.h"

namespace dermis::abi {

// Copied from the host. The problem says so where it has no such file, or no function to ask.
FileText ask_host(dermis_include_fn include, void* user, std::string_view name);

} // namespace dermis::abi
