#pragma once
// Passes that do not run where nothing scatters: in graphs without a profile, and in frames with empty
// bounds.

#include "framegraph/compile/plan.hpp"

#include <vector>

namespace dermis::abi {

// Turns passes off that serve scattering, and those that have to read what only such passes write where no
// `otherwise` stands in. For a graph without a profile.
void turn_scattering_off(Graph& graph, const KindRegistry& kinds);

struct LeftOut {                       // of a frame with empty bounds
  std::vector<uint8_t> passes;         // by plan pass, 1: does not run
  std::vector<uint32_t> unbound_ports; // by plan pass, bit i: port i of a pass of the host is not bound
};

// Passes that serve scattering; passes of the host that have to read what only such passes write, with a
// reason; and passes that only those need. Passes with side effects are needed.
LeftOut left_out_without_bounds(const KindRegistry& kinds, CompiledPlan& compiled);

} // namespace dermis::abi
