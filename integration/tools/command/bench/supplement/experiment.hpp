#pragma once
// The experiment of the 2021 paper's supplement, section 3: f = h(t) / (1 + y) and its control g = h(t) (1 -
// y) over [0, 1], 16 independent samples a frame, 100 frames; h = 1 (static) or 1 + 3 sin(t / 10) (dynamic).

#include <array>
#include <cstdint>
#include <string_view>

namespace dermis::tools {

inline constexpr std::array<std::string_view, 6> residual_names = {"res_f", "sf",       "sf_ema",
                                                                   "emcm",  "emcm_hat", "ground_truth"};

// The weight of the control for which the residual varies least, by the closed forms 12 (2 ln 2 - 1 - ln 2 /
// 2) and 2 ln 2.
double best_control_weight(bool dynamic);

// Mean over frames 25 to 100 of the root of the moving variance (eta .2) of each residual, of one run.
std::array<double, 6> run_supplement(bool dynamic, uint64_t seed);

// The best weight found from samples: static, the regression of f on g over `samples` of them; dynamic, of
// the frames' means of `samples` each, over 100 frames.
double sampled_control_weight(bool dynamic, uint32_t samples, uint64_t seed);

} // namespace dermis::tools
