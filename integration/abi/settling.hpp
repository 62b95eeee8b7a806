#pragma once
// How long a history remembers what was before a change.

#include "framegraph/compile/plan.hpp"

namespace dermis::abi {

// Frames after which at most 1 % of history `index` of the plan (Plan::histories) is from before a change of
// a profile or of light, by the weights that its writers mix with. 1: the history holds the last frame only.
// `settings`: by Graph::settings.
uint32_t settling_frames(const PassTypeRegistry& pass_types, const Plan& plan, uint32_t index,
                         const std::vector<SettingValue>& settings);

} // namespace dermis::abi
