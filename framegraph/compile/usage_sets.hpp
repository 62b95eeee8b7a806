#pragma once
// Stages, accesses and layout of each set of usages. Internal to compile/.

#include "framegraph/model/vocabulary.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace dermis {

inline constexpr auto usage_count = static_cast<uint32_t>(Usage::count);
inline constexpr uint32_t usage_sets = 1u << usage_count;
static_assert(usage_count <= 16, "PassAccess::usages and ObjectState::visible have 16 bits");

struct UsageSet {
  Stage stages = 0;
  Access access = 0;
  Layout image_layout = Layout::undefined; // `general` if the usages need different layouts
  uint16_t covers =
      0; // usages whose stages and accesses are a subset: a barrier for the set serves them, too
  bool reads = false, writes = false;
};

// Returns the sets by mask: bit 1 << usage for each usage of the set.
const std::array<UsageSet, usage_sets>& all_usage_sets();

} // namespace dermis
