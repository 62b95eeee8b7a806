#pragma once
// Finds races inside one pass. Its invocations run in no order, so no other access may use what one
// access writes, except to read the same texels (PlanAccess::own_texels). The kernel orders the
// accesses of one port by itself (PlanAccess::internally_ordered).

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
