#include "integration/tools/command/bench/merged_profiles.hpp"

#include <algorithm>
#include <array>

namespace dermis::tools {

void merge_profiles(std::vector<CaptureProfile>& merged, CapturedFrame& frame) {
  std::array<uint8_t, 256> renumbered{};
  std::vector<CaptureProfile> own;
  for (const CaptureProfile& one : frame.description.profiles) {
    auto known = std::find_if(merged.begin(), merged.end(), [&](const CaptureProfile& other) {
      return other.profile.name == one.profile.name && other.profile.d_mm == one.profile.d_mm;
    });
    if (known == merged.end()) {
      merged.push_back({static_cast<uint32_t>(merged.size() + 1), one.profile});
      known = merged.end() - 1;
    }
    renumbered[one.id] = static_cast<uint8_t>(known->id);
    own.push_back(*known);
  }
  for (uint8_t& id : frame.profile)
    id = renumbered[id];
  frame.description.profiles = own;
}

} // namespace dermis::tools
