#pragma once
// Draws the declared graph and the plan for Graphviz.

#include "framegraph/compile/plan.hpp"
#include "framegraph/model/graph.hpp"

#include <string>

namespace dermis {

// Passes are boxes (dashed: with a `when`), resources are ellipses (double for imports and
// exports). An arrow is a port; it is dashed if the port reads an earlier frame.
std::string graph_dot(const Graph& graph, const PassTypeRegistry& pass_types);

// Shows the passes that run, numbered, and the resources they use with format and size. Passes that
// do not run are grey, with the reason as a tooltip.
std::string plan_dot(const Graph& graph, const PassTypeRegistry& pass_types,
                     const CompiledPlan& compiled);

} // namespace dermis
