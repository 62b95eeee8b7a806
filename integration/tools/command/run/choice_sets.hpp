#pragma once
// Enumerates the configurations of a graph as values for --set and the C interface.

#include "integration/tools/command/graph_input.hpp"

#include <vector>

namespace dermis::tools {

// Returns one set of values per configuration (docs/choice.md), the defaults first; values are JSON
// text. Returns an empty list with errors in `diagnostics`.
std::vector<std::vector<NamedValue>> choice_sets(const LoadedGraph& loaded, const Size& size,
                                                 Diagnostics& diagnostics);

} // namespace dermis::tools
