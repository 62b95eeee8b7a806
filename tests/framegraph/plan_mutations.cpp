#include "tests/framegraph/plan_mutations.hpp"

namespace dermis::testing {

Plan without_barrier(const Plan& plan, uint32_t index) {
  Plan mutant = plan;
  mutant.barriers.erase(mutant.barriers.begin() + index);
  for (PlanPass& pass : mutant.passes) {
    if (index < pass.first_barrier)
      --pass.first_barrier;
    else if (index < pass.first_barrier + pass.barrier_count)
      --pass.barrier_count;
  }
  if (index < mutant.first_final_barrier)
    --mutant.first_final_barrier;
  else if (index < mutant.first_final_barrier + mutant.final_barrier_count)
    --mutant.final_barrier_count;
  return mutant;
}

Plan without_aliasing(const Plan& plan) {
  Plan apart = plan;
  for (Heap& heap : apart.heaps)
    heap.size = 0;
  for (Placement& placement : apart.placements) {
    uint64_t& end = apart.heaps[placement.heap].size;
    placement.offset = (end + placement.alignment - 1) / placement.alignment * placement.alignment;
    end = placement.offset + placement.size;
  }
  return apart;
}

} // namespace dermis::testing
