#include "framegraph/verify/within_pass.hpp"

#include "framegraph/verify/structure.hpp"
#include "framegraph/verify/subresource_ranges.hpp"

namespace dermis {
namespace {

// Returns the instance of the resource that the access names in this frame.
uint32_t instance_of(const Plan& plan, const PlanAccess& access, uint32_t frame) {
  const uint32_t count = plan.resources[access.resource].instance_count;
  return (frame % count + count - access.frames_back % count) % count;
}

bool lie_in_same_memory(const Plan& plan, const PlanAccess& a, const PlanAccess& b,
                        uint32_t frame) {
  const uint32_t first = plan.resources[a.resource].first_instance;
  const uint32_t second = plan.resources[b.resource].first_instance;
  // host memory: nothing else lies there
  if (first == no_instance || second == no_instance) return false;
  return share_memory(plan.placements[first + instance_of(plan, a, frame)],
                      plan.placements[second + instance_of(plan, b, frame)]);
}

const char* race_of(const Plan& plan, const PlanAccess& write, const PlanAccess& other,
                    uint32_t frame) {
  if (write.resource != other.resource ||
      instance_of(plan, write, frame) != instance_of(plan, other, frame))
    return lie_in_same_memory(plan, write, other, frame)
               ? "aliases memory that the same pass writes"
               : nullptr;
  const bool own = (other.access & all_write_access) == 0 && other.own_texels;
  if (own || !overlap(write.range, other.range)) return nullptr;
  return "is read without own_texels by the pass that writes it";
}

} // namespace

std::vector<PassRace> races_within(const Plan& plan, const PlanPass& pass, uint32_t frame) {
  std::vector<PassRace> races;
  const PlanAccess* accesses = plan.accesses.data() + pass.first_access;
  for (uint32_t w = 0; w < pass.access_count; ++w) {
    if ((accesses[w].access & all_write_access) == 0) continue;
    for (uint32_t a = 0; a < pass.access_count; ++a) {
      if (a == w) continue;
      if (const char* what = race_of(plan, accesses[w], accesses[a], frame))
        races.push_back({accesses[a].resource, accesses[a].frames_back, what});
    }
  }
  return races;
}

} // namespace dermis
