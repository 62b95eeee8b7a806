#pragma once
// Pictures for Graphviz: the graph as declared, and the plan as it will run.

#include "framegraph/compile/plan.hpp"
#include "framegraph/model/graph.hpp"

#include <string>

namespace dermis {

// Passes are boxes (dashed: with a `when`), resources ellipses (imports and exports drawn double); an arrow
// is a port, dashed where it reads an earlier frame.
std::string graph_dot(const Graph& graph, const PassTypeRegistry& pass_types);

// The passes that run, numbered, and the resources they touch with format and size; passes that do not run
// are grey, with the reason as a tooltip.
std::string plan_dot(const Graph& graph, const PassTypeRegistry& pass_types, const CompiledPlan& compiled);

} // namespace dermis
