#include "framegraph/verify/overlaps.hpp"

#include "framegraph/verify/structure.hpp"

#include <algorithm>
#include <tuple>

namespace dermis {

// In the order of the heap: behind an instance's end nothing overlaps it.
std::vector<std::vector<uint32_t>> overlaps_of(const Plan& plan,
                                               const std::vector<InstanceThings>& instances) {
  std::vector<std::vector<uint32_t>> overlapping(instances.size());
  std::vector<uint32_t> placed;
  for (uint32_t i = 0; i < instances.size(); ++i)
    if (instances[i].placement != no_instance) placed.push_back(i);
  const auto memory = [&](uint32_t i) -> const Placement& { return plan.placements[instances[i].placement]; };
  std::sort(placed.begin(), placed.end(), [&](uint32_t a, uint32_t b) {
    return std::tuple(memory(a).heap, memory(a).offset, a) < std::tuple(memory(b).heap, memory(b).offset, b);
  });
  for (size_t i = 0; i < placed.size(); ++i) {
    const Placement& own = memory(placed[i]);
    for (size_t k = i + 1; k < placed.size(); ++k) {
      const Placement& other = memory(placed[k]);
      if (other.heap != own.heap || other.offset >= own.offset + own.size) break;
      if (!share_memory(own, other)) continue;
      overlapping[placed[i]].push_back(placed[k]);
      overlapping[placed[k]].push_back(placed[i]);
    }
  }
  return overlapping;
}

} // namespace dermis
