#pragma once
// Plans changed by hand, for tests that ask who notices.

#include "framegraph/compile/plan.hpp"

#include <functional>
#include <string>

namespace dermis::testing {

Plan without_barrier(const Plan& plan, uint32_t index);

// Every placement in memory of its own.
Plan without_aliasing(const Plan& plan);

// Calls with each plan that differs from `plan` by one change, and with what was changed.
using VisitMutant = std::function<void(const Plan& mutant, const std::string& what)>;

void for_each_weaker_mask(const Plan& plan, const VisitMutant& visit);       // one bit of one barrier missing
void for_each_shifted_placement(const Plan& plan, const VisitMutant& visit); // to where another one begins
void for_each_flipped_slot(const Plan& plan, const VisitMutant& visit);      // an access to another old frame
void for_each_lost_own_texels(const Plan& plan, const VisitMutant& visit);
void for_each_redirected_access(const Plan& plan, const VisitMutant& visit); // to what its pass writes
void for_each_swap(const Plan& plan, const VisitMutant& visit); // of two passes that follow each other
void for_each_moved_barrier(const Plan& plan, const VisitMutant& visit); // to the pass before or after

// A wait missing or for the point before; a signal missing, so that all who waited for it do so for the one
// before.
void for_each_lost_point(const Plan& plan, const VisitMutant& visit);

} // namespace dermis::testing
