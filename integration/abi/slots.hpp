#pragma once
// Describes the slots of a graph: its imports and exports in file order, with the compiled plan's
// use of them.

#include "integration/abi/compiled_graph.hpp"

#include <span>

namespace dermis::abi {

// Position i is PlanResource::slot i, the host's slot id. `left_out`: by plan pass whether frames
// with empty bounds leave it out.
std::vector<Slot> make_slots(const Graph& graph, const Plan& plan,
                             std::span<const uint8_t> left_out);

// Reports names in the host's lists that are not slots of the graph. Each probably misspelt name
// gets a warning; all others share one note, so that a list may serve several graphs.
void report_unknown_slots(const Graph& graph, std::span<const std::string> unbound,
                          std::span<const HostFormat> formats, Diagnostics& diagnostics);

// Returns for each resource false if it is an optional slot that the host names as unbound. Names
// of required slots are errors; names without a slot are ignored.
std::vector<bool> bound_resources(const Graph& graph, std::span<const std::string> unbound,
                                  Diagnostics& diagnostics);

// Returns for each resource the format that the host will bind; undefined if the host names none.
std::vector<Format> host_formats(const Graph& graph, std::span<const HostFormat> formats);

} // namespace dermis::abi
