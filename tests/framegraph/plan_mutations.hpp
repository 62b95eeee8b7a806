#pragma once
// Modified plans for mutation tests.

#include "framegraph/compile/plan.hpp"

#include <functional>
#include <string>

namespace dermis::testing {

Plan without_barrier(const Plan& plan, uint32_t index);

// Returns the plan with separate memory for every placement.
Plan without_aliasing(const Plan& plan);

// Calls with each plan that differs from `plan` by one change, and with a description of the
// change.
using VisitMutant = std::function<void(const Plan& mutant, const std::string& what)>;

// Clears one bit of one barrier's masks.
void for_each_weaker_mask(const Plan& plan, const VisitMutant& visit);
// Moves a placement to the beginning of another placement.
void for_each_shifted_placement(const Plan& plan, const VisitMutant& visit);
// Makes an access read another old frame.
void for_each_flipped_slot(const Plan& plan, const VisitMutant& visit);
void for_each_lost_declaration(const Plan& plan, const VisitMutant& visit);
// Redirects an access to a resource that its pass writes.
void for_each_redirected_access(const Plan& plan, const VisitMutant& visit);
void for_each_swap(const Plan& plan, const VisitMutant& visit); // Swaps two consecutive passes.
// Moves a barrier to the previous or next pass.
void for_each_moved_barrier(const Plan& plan, const VisitMutant& visit);

// Removes a wait or lowers it to the previous point; removes a signal, so that its waits use the
// previous point.
void for_each_lost_point(const Plan& plan, const VisitMutant& visit);

} // namespace dermis::testing
