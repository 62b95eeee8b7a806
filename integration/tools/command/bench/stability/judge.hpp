#pragma once
// Measures the error of a frame's result.

#include "integration/tools/command/bench/stability/cases.hpp"

#include <vector>

namespace dermis::tools {

struct StabilityAnswer {
  std::vector<float> light;   // 3 values per pixel
  std::vector<float> samples; // of TechniqueRun::sampling, 3 values per pixel; empty if not judged
};

struct Judgement {
  uint64_t nonfinite = 0; // pixels
  uint64_t negative = 0;  // number of finite pixels with a negative value
  double error = 0;       // as defined by StabilityCase::metric
};

// Judges frame `t` of the case. `sound` is the result of `same_as`, if the case has it.
Judgement judge(const StabilityCase& requested, uint32_t t, const StabilityAnswer& found,
                const StabilityAnswer* sound);

} // namespace dermis::tools
