#pragma once
// Writes the plan as human-readable text: what runs, what waits for what and why, and the memory
// layout.

#include "framegraph/compile/plan.hpp"
#include "framegraph/compose/compose.hpp"
#include "framegraph/model/graph.hpp"

#include <string>

namespace dermis {

// Returns several lines with a newline at the end. `provenance` lists what other files changed in
// the graph.
std::string plan_text(const Graph& graph, const PassTypeRegistry& pass_types,
                      const CompiledPlan& compiled, const Provenance& provenance = {});

} // namespace dermis
