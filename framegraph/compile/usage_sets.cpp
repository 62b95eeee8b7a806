#include "framegraph/compile/usage_sets.hpp"

namespace dermis {
namespace {

std::array<UsageSet, usage_sets> make_usage_sets() {
  std::array<UsageSet, usage_sets> sets{};
  for (uint32_t mask = 1; mask < usage_sets; ++mask) {
    UsageSet& set = sets[mask];
    for (uint32_t u = 0; u < usage_count; ++u) {
      if ((mask >> u & 1) == 0) continue;
      const UsageInfo& info = usage_info(static_cast<Usage>(u));
      set.image_layout =
          set.stages == 0 || set.image_layout == info.layout ? info.layout : Layout::general;
      set.stages |= info.stages;
      set.access |= info.access;
      set.reads |= info.reads;
      set.writes |= info.writes;
      for (uint32_t other = 0; other < usage_count; ++other) {
        const UsageInfo& other_info = usage_info(static_cast<Usage>(other));
        if ((other_info.stages & ~info.stages) == 0 && (other_info.access & ~info.access) == 0)
          set.covers = static_cast<uint16_t>(set.covers | 1u << other);
      }
    }
  }
  return sets;
}

} // namespace

const std::array<UsageSet, usage_sets>& all_usage_sets() {
  static const std::array<UsageSet, usage_sets> sets = make_usage_sets();
  return sets;
}

} // namespace dermis
