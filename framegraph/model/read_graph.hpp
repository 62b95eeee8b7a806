#pragma once
// Converts a Document into a Graph according to docs/format.md. Every name is resolved, and errors
// name both locations involved.

#include "framegraph/model/graph.hpp"
#include "framegraph/model/pass_type.hpp"
#include "framegraph/text/document.hpp"

#include <optional>

namespace dermis {

// Returns the graph, or nullopt with errors in `diagnostics`. Reports all root causes in one run,
// without their consequences. Looks up pass types in `pass_types`, which the graph's PassTypeIds
// refer to. Free-threaded.
std::optional<Graph> read_graph(const Document& document, const PassTypeRegistry& pass_types,
                                Diagnostics& diagnostics);

} // namespace dermis
