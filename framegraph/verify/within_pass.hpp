#pragma once
// Races inside one pass: its invocations run in no order, so that what one of its accesses writes no other
// one may touch, except to read the same thing texel by texel (PlanAccess::own_texels).

#include "framegraph/compile/plan.hpp"

#include <cstdint>
#include <vector>

namespace dermis {

struct PassRace {
  uint32_t resource = 0, frames_back = 0; // what is touched while it is written
  const char* what = "";
};

// In frame number `frame`. `plan` must pass verify_structure().
std::vector<PassRace> races_within(const Plan& plan, const PlanPass& pass, uint32_t frame);

} // namespace dermis
