#pragma once
// Which instances have bytes in common.

#include "framegraph/compile/plan.hpp"
#include "framegraph/verify/things.hpp"

#include <cstdint>
#include <vector>

namespace dermis {

// By instance: the others whose placements share a byte with its own. `plan` must pass verify_structure(),
// which bounds them.
std::vector<std::vector<uint32_t>> overlaps_of(const Plan& plan,
                                               const std::vector<InstanceThings>& instances);

} // namespace dermis
