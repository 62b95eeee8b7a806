#pragma once
// Finds races between invocations of one pass, which run concurrently. A subresource that one
// access writes may have no other access in the pass. Exceptions: each invocation reads only the
// texels that it writes (PlanAccess::own_texels), or the kernel synchronizes the accesses of the
// port (PlanAccess::internally_ordered).

#include "framegraph/compile/plan.hpp"

#include <cstdint>
#include <vector>

namespace dermis {

struct PassRace {
  uint32_t resource = 0, frames_back = 0; // the resource that is accessed while it is written
  const char* what = "";
};

// Returns the races of `pass` in frame number `frame`. `plan` must pass verify_structure().
std::vector<PassRace> races_within(const Plan& plan, const PlanPass& pass, uint32_t frame);

} // namespace dermis
