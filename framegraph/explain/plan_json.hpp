#pragma once
// The whole plan as JSON, complete enough for a stranger's program to check or to run it.

#include "framegraph/compile/plan.hpp"
#include "framegraph/compose/compose.hpp"
#include "framegraph/model/graph.hpp"

#include <string>

namespace dermis {

inline constexpr uint32_t plan_json_version = 2; // of the layout below; raised when a reader could be misled

// Every index that the document uses is the position in the array it refers to. Masks are written as a hex
// string (they have 64 bits, which JSON numbers do not) and as names. `graph` and `pass_types` are those it
// was compiled from; `provenance` tells what other files than the graph's did to it. The same plan gives the
// same bytes.
std::string plan_json(const Graph& graph, const PassTypeRegistry& pass_types, const CompiledPlan& compiled,
                      const Provenance& provenance = {});

} // namespace dermis
