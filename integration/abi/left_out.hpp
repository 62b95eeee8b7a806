#pragma once
// Passes that do not run where nothing scatters: in graphs without a profile, and in frames with empty
// bounds.

#include "framegraph/compile/plan.hpp"

#include <vector>

namespace dermis::abi {

// Turns passes off that serve scattering, and those that have to read what only such passes write where no
// `otherwise` stands in. For a graph without a profile, and for the plan of frames with empty bounds.
void turn_scattering_off(Graph& graph, const PassTypeRegistry& pass_types);

// By plan pass, 1: does not run in a frame with empty bounds. Passes that serve scattering, and passes that
// only those need. Passes with side effects are needed.
std::vector<uint8_t> left_out_without_bounds(const PassTypeRegistry& pass_types, const Plan& plan);

// Returns whether a pass that does not serve scattering reads what only passes that do so have written by
// then. A frame with empty bounds then needs a plan of its own, in which each port gets its `otherwise`, is
// unbound, or turns the pass off.
bool reads_what_is_left_out(const PassTypeRegistry& pass_types, const Plan& plan);

// Adds a reason for each pass of the plan that `without_scattering`, which turn_scattering_off() changed,
// turned off for lack of an input.
void explain_lacking_inputs(const Graph& without_scattering, CompiledPlan& compiled);

} // namespace dermis::abi
