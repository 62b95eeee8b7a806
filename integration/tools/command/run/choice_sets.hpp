#pragma once
// What a graph's choices by budget can come to, as values for --set and the C interface.

#include "integration/tools/command/graph_input.hpp"

#include <vector>

namespace dermis::tools {

// One set of values for each outcome (docs/choice.md), the defaults first; values are JSON text. Empty with
// errors in `diagnostics`.
std::vector<std::vector<NamedValue>> choice_sets(const LoadedGraph& loaded, const Size& size,
                                                 Diagnostics& diagnostics);

} // namespace dermis::tools
