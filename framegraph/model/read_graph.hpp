#pragma once
// Document -> Graph: the file format of docs/format.md, every name resolved, every error with both its ends.

#include "framegraph/model/graph.hpp"
#include "framegraph/model/pass_kind.hpp"
#include "framegraph/text/document.hpp"

#include <optional>

namespace dermis {

// The graph, or nullopt with errors in `diagnostics`. Reports all root causes in one run; what only follows
// from one of them stays silent. Kinds are looked up in `kinds`; the graph holds KindIds of it.
// Free-threaded.
std::optional<Graph> read_graph(const Document& document, const KindRegistry& kinds,
                                Diagnostics& diagnostics);

} // namespace dermis
