#include "tests/framegraph/plan_mutations.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace dermis::testing {

Plan without_barrier(const Plan& plan, uint32_t index) {
  Plan mutant = plan;
  mutant.barriers.erase(mutant.barriers.begin() + index);
  for (PlanPass& pass : mutant.passes) {
    if (index < pass.first_barrier)
      --pass.first_barrier;
    else if (index < pass.first_barrier + pass.barrier_count)
      --pass.barrier_count;
    else if (index < pass.first_barrier + pass.barrier_count + pass.release_count)
      --pass.release_count;
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

void for_each_weaker_mask(const Plan& plan, const VisitMutant& visit) {
  constexpr std::pair<const char*, uint64_t PlanBarrier::*> masks[] = {
      {"source stages", &PlanBarrier::source_stages},
      {"source access", &PlanBarrier::source_access},
      {"destination stages", &PlanBarrier::destination_stages},
      {"destination access", &PlanBarrier::destination_access}};
  for (size_t b = 0; b < plan.barriers.size(); ++b)
    for (const auto& [name, mask] : masks)
      for (uint64_t bit = 1; bit != 0; bit <<= 1u) {
        if ((plan.barriers[b].*mask & bit) == 0) continue;
        Plan mutant = plan;
        mutant.barriers[b].*mask &= ~bit;
        visit(mutant, fmt::format("barrier {} without {:#x} in its {}", b, bit, name));
      }
}

void for_each_shifted_placement(const Plan& plan, const VisitMutant& visit) {
  for (size_t i = 0; i < plan.placements.size(); ++i)
    for (size_t k = 0; k < plan.placements.size(); ++k) {
      const Placement &moved = plan.placements[i], &onto = plan.placements[k];
      if (i == k || moved.heap != onto.heap || moved.offset == onto.offset) continue;
      Plan mutant = plan;
      mutant.placements[i].offset = onto.offset;
      // The heap grows with the placement, so that the mutant does not fail the bounds check.
      Heap& heap = mutant.heaps[moved.heap];
      heap.size = std::max(heap.size, onto.offset + moved.size);
      visit(mutant, fmt::format("placement {} at the offset of {}", i, k));
    }
}

void for_each_flipped_slot(const Plan& plan, const VisitMutant& visit) {
  std::vector<uint32_t> frames(plan.resources.size(), 0);
  for (const PlanHistory& history : plan.histories)
    frames[history.resource] = history.frames;
  for (size_t a = 0; a < plan.accesses.size(); ++a)
    for (uint32_t back = 0; back <= frames[plan.accesses[a].resource]; ++back) {
      if (back == plan.accesses[a].frames_back) continue;
      Plan mutant = plan;
      mutant.accesses[a].frames_back = back;
      visit(mutant, fmt::format("access {} to the contents of {} frames back", a, back));
    }
}

void for_each_lost_declaration(const Plan& plan, const VisitMutant& visit) {
  for (size_t a = 0; a < plan.accesses.size(); ++a) {
    if (!plan.accesses[a].own_texels) continue;
    Plan mutant = plan;
    mutant.accesses[a].own_texels = false;
    visit(mutant, fmt::format("access {} to texels of other invocations", a));
  }
  for (size_t a = 0; a < plan.accesses.size(); ++a) {
    if (!plan.accesses[a].internally_ordered) continue;
    Plan mutant = plan;
    mutant.accesses[a].internally_ordered = false;
    visit(mutant, fmt::format("access {} to what was there before", a));
  }
}

void for_each_redirected_access(const Plan& plan, const VisitMutant& visit) {
  for (const PlanPass& pass : plan.passes)
    for (uint32_t a = pass.first_access; a < pass.first_access + pass.access_count; ++a)
      for (uint32_t k = pass.first_access; k < pass.first_access + pass.access_count; ++k) {
        const PlanAccess& onto = plan.accesses[k];
        if (a == k || (onto.access & all_write_access) == 0) continue;
        Plan mutant = plan;
        mutant.accesses[a].resource = onto.resource;
        mutant.accesses[a].frames_back = onto.frames_back;
        mutant.accesses[a].range = onto.range;
        mutant.accesses[a].layout = onto.layout;
        visit(mutant, fmt::format("access {} to what access {} writes", a, k));
      }
}

void for_each_swap(const Plan& plan, const VisitMutant& visit) {
  for (size_t p = 0; p + 1 < plan.passes.size(); ++p) {
    Plan mutant = plan;
    std::swap(mutant.passes[p], mutant.passes[p + 1]);
    visit(mutant, fmt::format("pass {} after the next one", p));
  }
}

void for_each_moved_barrier(const Plan& plan, const VisitMutant& visit) {
  for (size_t p = 0; p + 1 < plan.passes.size(); ++p) {
    const PlanPass &first = plan.passes[p], &second = plan.passes[p + 1];
    if (first.first_barrier + first.barrier_count != second.first_barrier ||
        first.queue != second.queue)
      continue;
    if (first.barrier_count > 0) {
      Plan mutant = plan;
      --mutant.passes[p].barrier_count;
      ++mutant.passes[p + 1].barrier_count;
      --mutant.passes[p + 1].first_barrier;
      visit(mutant, fmt::format("the last barrier of pass {} one pass later", p));
    }
    if (second.barrier_count > 0) {
      Plan mutant = plan;
      ++mutant.passes[p].barrier_count;
      --mutant.passes[p + 1].barrier_count;
      ++mutant.passes[p + 1].first_barrier;
      visit(mutant, fmt::format("the first barrier of pass {} one pass earlier", p + 1));
    }
  }
}

namespace {

// Waits for the removed point become waits for the previous point; later points are renumbered.
Plan without_signal(const Plan& plan, size_t pass) {
  Plan mutant = plan;
  const uint32_t lost = plan.passes[pass].signal;
  const Queue queue = plan.passes[pass].queue;
  const auto lower = [&](uint32_t& point) {
    if (point != no_point && point >= lost) --point;
  };
  for (PlanPass& other : mutant.passes)
    if (other.queue == queue)
      lower(other.signal);
    else
      lower(other.wait);
  if (queue == Queue::async) lower(mutant.final_wait);
  mutant.passes[pass].signal = 0;
  return mutant;
}

} // namespace

void for_each_lost_point(const Plan& plan, const VisitMutant& visit) {
  for (size_t p = 0; p < plan.passes.size(); ++p) {
    if (plan.passes[p].wait != no_point) {
      Plan mutant = plan;
      mutant.passes[p].wait = no_point;
      visit(mutant, fmt::format("pass {} without its wait", p));
      if (plan.passes[p].wait > 0) {
        mutant.passes[p].wait = plan.passes[p].wait - 1;
        visit(mutant, fmt::format("pass {} waits for an earlier point", p));
      }
    }
    if (plan.passes[p].signal != 0)
      visit(without_signal(plan, p), fmt::format("pass {} without its signal", p));
  }
  if (plan.final_wait != no_point) {
    Plan mutant = plan;
    mutant.final_wait = no_point;
    visit(mutant, "no wait at the end");
    mutant.final_wait = plan.final_wait - 1;
    visit(mutant, "the end waits for an earlier point");
  }
}

} // namespace dermis::testing
