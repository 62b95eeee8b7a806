#pragma once
// The experiment of the 2021 paper's supplement, section 3: f = h(t) / (1 + y) and its control g =
// h(t) (1 - y) over [0, 1], 16 independent samples per frame, 100 frames. h = 1 (static) or 1 + 3
// sin(t / 10) (dynamic).

#include <array>
#include <cstdint>
#include <string_view>

namespace dermis::tools {

inline constexpr std::array<std::string_view, 6> residual_names = {
    "res_f", "sf", "sf_ema", "emcm", "emcm_hat", "ground_truth"};

// Returns the weight of the control with the smallest variance of the residual, in closed form: 12
// (2 ln 2 - 1 - ln 2 / 2) (static) or 2 ln 2 (dynamic).
double best_control_weight(bool dynamic);

// Returns, for one run, the mean over frames 25 to 100 of the root of each residual's moving
// variance (eta 0.2).
std::array<double, 6> run_supplement(bool dynamic, uint64_t seed);

// Returns the best weight found from samples. Static: the regression of f on g over `samples`
// samples. Dynamic: the regression of the means of 100 frames with `samples` samples each.
double sampled_control_weight(bool dynamic, uint32_t samples, uint64_t seed);

} // namespace dermis::tools
