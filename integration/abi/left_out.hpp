#pragma once
// Finds passes that do not run if nothing scatters: in graphs without a profile, and in frames with
// empty bounds.

#include "framegraph/compile/plan.hpp"

#include <vector>

namespace dermis::abi {

// Turns off passes that serve scattering, and passes that must read what only such passes write if
// no `otherwise` replaces it. Used for graphs without a profile, and for the plan of frames with
// empty bounds.
void turn_scattering_off(Graph& graph, const PassTypeRegistry& pass_types);

// Returns 1 for each plan pass that does not run in a frame with empty bounds: passes that serve
// scattering, and passes that only those need. Passes with side effects always run.
std::vector<uint8_t> left_out_without_bounds(const PassTypeRegistry& pass_types, const Plan& plan);

// Returns whether a pass that does not serve scattering reads what only earlier passes that do
// serve scattering have written, or what their `otherwise` replaces. A frame with empty bounds then
// needs its own plan, in which each such port gets its `otherwise`, is unbound, or turns the pass
// off. `graph`: of the plan.
bool reads_what_is_left_out(const Graph& graph, const PassTypeRegistry& pass_types,
                            const Plan& plan);

// Adds a reason for each pass of the plan that turn_scattering_off() turned off in
// `without_scattering` for lack of an input.
void explain_lacking_inputs(const Graph& without_scattering, CompiledPlan& compiled);

} // namespace dermis::abi
