#pragma once
// The plan as a text for people: what runs, what waits for what and why, where it lies in memory.

#include "framegraph/compile/plan.hpp"
#include "framegraph/compose/compose.hpp"
#include "framegraph/model/graph.hpp"

#include <string>

namespace dermis {

// Several lines, newline at the end. `provenance` tells what other files than the graph's did to it.
std::string plan_text(const Graph& graph, const PassTypeRegistry& pass_types, const CompiledPlan& compiled,
                      const Provenance& provenance = {});

} // namespace dermis
