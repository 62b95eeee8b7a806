#pragma once
// The slots of a graph: its imports and exports in file order, with what the compiled plan made of them.

#include "integration/abi/program.hpp"

#include <span>

namespace dermis::abi {

// Position i is PlanResource::slot i, which is the host's slot id.
std::vector<Slot> make_slots(const Graph& graph, const Plan& plan);

// Reports names in the host's lists that are no slot of the graph: each one that is probably misspelt as a
// warning, all others together in one note, so that one list may serve several graphs.
void report_unknown_slots(const Graph& graph, std::span<const std::string> unbound,
                          std::span<const HostFormat> formats, Diagnostics& diagnostics);

// By resource: false for the optional slots that the host names as unbound. Names of required slots are
// errors; names without a slot are ignored.
std::vector<bool> bound_resources(const Graph& graph, std::span<const std::string> unbound,
                                  Diagnostics& diagnostics);

// By resource: the formats that the host will bind, undefined where the host names none.
std::vector<Format> host_formats(const Graph& graph, std::span<const HostFormat> formats);

} // namespace dermis::abi
