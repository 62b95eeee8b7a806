#pragma once
// Draws the plan for Graphviz.

#include "framegraph/compile/plan.hpp"
#include "framegraph/model/graph.hpp"

#include <string>

namespace dermis {

// Passes are numbered boxes, resources are ellipses (double for imports and exports) with format
// and size. An arrow is a port; it is dashed if the port reads an earlier frame. Passes that do not
// run are grey, with the reason as a tooltip.
std::string plan_dot(const Graph& graph, const PassTypeRegistry& pass_types,
                     const CompiledPlan& compiled);

} // namespace dermis
