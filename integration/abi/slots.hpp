#pragma once
// The slots of a graph: its imports and exports in file order, with what the compiled plan made of them.

#include "integration/abi/program.hpp"

#include <span>

namespace dermis::abi {

// Position i is PlanResource::slot i, which is the host's slot id.
std::vector<Slot> make_slots(const Graph& graph, const Plan& plan);

// By resource: false for the optional slots that the host names as unbound. Names that are no slot become
// warnings, so that a host may state once what it has for graphs that differ; required ones become errors.
std::vector<bool> bound_resources(const Graph& graph, std::span<const std::string> unbound,
                                  Diagnostics& diagnostics);

// By resource: the formats the host will bind, undefined where it says nothing.
std::vector<Format> host_formats(const Graph& graph, std::span<const HostFormat> formats,
                                 Diagnostics& diagnostics);

} // namespace dermis::abi
