#include "integration/abi/settling.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::abi {
namespace {

constexpr double remainder = 0.01; // fraction of the history from before the change

// A running mean x' = (1 - fraction) x + fraction * new keeps (1 - fraction)^n of the first value
// after n frames.
double frames_of(const HistoryWeight& mix, double value) {
  const double fraction = mix.by == HistoryWeight::By::cap ? 1 / (1 + value) : value;
  if (fraction >= 1) return mix.frames;
  return std::ceil(std::log(remainder) / std::log1p(-fraction)) * mix.frames;
}

} // namespace

uint32_t settling_frames(const PassTypeRegistry& pass_types, const Plan& plan, uint32_t index,
                         const std::vector<SettingValue>& settings) {
  double frames = 1;
  for (const PlanPass& pass : plan.passes) {
    const PassType& type = pass_types[pass.type];
    for (const PlanAccess& access :
         std::span(plan.accesses).subspan(pass.first_access, pass.access_count)) {
      if (access.resource != plan.histories[index].resource || access.frames_back != 0 ||
          (access.access & all_write_access) == 0)
        continue;
      for (const HistoryWeight& mix : type.mixes) {
        if (type.ports[access.port].name != mix.port) continue;
        const auto setting = static_cast<uint32_t>(find_setting(type, mix.setting));
        const PlanSetting& planned = plan.settings[pass.first_setting + setting];
        const SettingValue& value =
            planned.from.valid() ? settings[planned.from.value] : planned.value;
        frames = std::max(frames, frames_of(mix, value.real));
      }
    }
  }
  return static_cast<uint32_t>(std::min(frames, double{UINT32_MAX}));
}

} // namespace dermis::abi
