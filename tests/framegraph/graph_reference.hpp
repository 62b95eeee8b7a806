#pragma once
// Computes the result of a graph from its declarations only: passes run in file order, and each
// resource has its own contents. No plan, memory or barriers are involved.

#include "framegraph/model/graph.hpp"
#include "tests/framegraph/interpret/interpret.hpp"

namespace dermis::testing {

// Returns what interpret() returns for a plan of the graph, for every exported slot. Settings have
// their defaults, all slots are bound, and passes follow the producers of what they read, as in
// random_graph().
Interpretation graph_reference(const Graph& graph, const PassTypeRegistry& pass_types,
                               uint32_t frames, uint64_t contents,
                               uint64_t cuts = 0); // Bit f: the camera cuts before frame f.

// Compares only the slots that `reference` contains.
bool agrees(const Interpretation& found, const Interpretation& reference);

} // namespace dermis::testing
