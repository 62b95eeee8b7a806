#pragma once
// Estimates how long a history contains data from before a change.

#include "framegraph/compile/plan.hpp"

namespace dermis::abi {

// Returns the number of frames after which at most 1 % of history `index` of the plan
// (Plan::histories) is from before a change of a profile or of light. Uses the blend weights of the
// history's writers. 1: the history only holds the last frame. `settings`: by Graph::settings.
uint32_t settling_frames(const PassTypeRegistry& pass_types, const Plan& plan, uint32_t index,
                         const std::vector<SettingValue>& settings);

} // namespace dermis::abi
