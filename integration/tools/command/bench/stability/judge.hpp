#pragma once
// How far off a frame's answer is.

#include "integration/tools/command/bench/stability/cases.hpp"

#include <vector>

namespace dermis::tools {

struct StabilityAnswer {
  std::vector<float> light;   // 3 values a pixel
  std::vector<float> samples; // of TechniqueRun::sampling, 3 values a pixel; empty where nobody asks
};

struct Judgement {
  uint64_t nonfinite = 0; // pixels
  uint64_t negative = 0;  // pixels, of those that are finite
  double error = 0;       // as StabilityCase::judged says
};

// Frame `t` of the case. `sound`: the answer to `same_as`, where the case has it.
Judgement judge(const StabilityCase& requested, uint32_t t, const StabilityAnswer& found,
                const StabilityAnswer* sound);

} // namespace dermis::tools
