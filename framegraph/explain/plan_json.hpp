#pragma once
// Writes the whole plan as JSON, complete enough for another program to check or run it.

#include "framegraph/compile/plan.hpp"
#include "framegraph/compose/compose.hpp"
#include "framegraph/model/graph.hpp"

#include <string>

namespace dermis {

// version of the layout; raised if a change could mislead readers
inline constexpr uint32_t plan_json_version = 2;

// Returns the document. Every index is the position in the array that it refers to. Masks are
// written as a hex string, because JSON numbers do not have 64 bits, and as names. The plan must
// have been compiled from `graph` and `pass_types`; `provenance` lists what other files changed in
// the graph. Equal plans give equal bytes.
std::string plan_json(const Graph& graph, const PassTypeRegistry& pass_types,
                      const CompiledPlan& compiled, const Provenance& provenance = {});

} // namespace dermis
