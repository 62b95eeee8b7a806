#pragma once
// Document -> Graph: the file format of docs/format.md, every name resolved, every error with both its ends.

#include "framegraph/model/graph.hpp"
#include "framegraph/model/pass_type.hpp"
#include "framegraph/text/document.hpp"

#include <optional>

namespace dermis {

// The graph, or nullopt with errors in `diagnostics`. Reports all root causes in one run; what only follows
// from one of them stays silent. Kinds are looked up in `pass_types`; the graph holds PassTypeIds of it.
// Free-threaded.
std::optional<Graph> read_graph(const Document& document, const PassTypeRegistry& pass_types,
                                Diagnostics& diagnostics);

} // namespace dermis
