#pragma once
// What a graph means, computed from its declarations alone: every pass in the order of the file, every
// resource with contents of its own. No plan, no memory, no barriers.

#include "framegraph/model/graph.hpp"
#include "tests/framegraph/interpret/interpret.hpp"

namespace dermis::testing {

// Like interpret() of its plan, for every slot that is exported. Settings have their defaults, all slots are
// bound, and passes stand behind the producers of what they read, as in random_graph().
Interpretation graph_reference(const Graph& graph, const PassTypeRegistry& pass_types, uint32_t frames,
                               uint64_t contents,
                               uint64_t cuts = 0); // bit f: the camera jumps before frame f

// Slots that `truth` says nothing about may hold anything.
bool agrees(const Interpretation& found, const Interpretation& reference);

} // namespace dermis::testing
