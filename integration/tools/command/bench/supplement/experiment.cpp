#include "integration/tools/command/bench/supplement/experiment.hpp"

#include "integration/tools/references/moving.hpp"

#include <cmath>
#include <optional>

namespace dermis::tools {
namespace {

using subsurface::MovingCovariance;
using subsurface::MovingVariance;

constexpr int frames = 100, first_counted = 24, samples_a_frame = 16;
constexpr double eta_residual = 0.2, eta_covariance = 0.05;
const double ln2 = std::log(2.0);

// SplitMix64 (Steele et al. 2014), for equal numbers on every compiler.
struct Uniform {
  uint64_t state;
  double next() {
    uint64_t z = (state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }
};

double light(bool dynamic, int frame) {
  return dynamic ? 1 + 3 * std::sin(frame / 10.0) : 1;
}

struct Frame {
  double f = 0, g = 0;                   // means of its samples
  double covariance = 0, variance_g = 0; // of its samples
};

Frame draw(Uniform& random, double h, uint32_t samples) {
  double f = 0, g = 0, fg = 0, gg = 0;
  for (uint32_t i = 0; i < samples; ++i) {
    const double y = random.next(), a = h / (1 + y), b = h * (1 - y);
    f += a;
    g += b;
    fg += a * b;
    gg += b * b;
  }
  const double n = samples;
  return {f / n, g / n, fg / n - f * g / (n * n), gg / n - g * g / (n * n)};
}

} // namespace

double best_control_weight(bool dynamic) {
  return dynamic ? 2 * ln2 : 12 * (2 * ln2 - 1 - ln2 / 2);
}

std::array<double, 6> run_supplement(bool dynamic, uint64_t seed) {
  Uniform random{seed};
  const double best = best_control_weight(dynamic);
  std::array<MovingVariance, 6> spread{};
  std::array<double, 6> mean{};
  MovingCovariance moments;
  std::optional<double> single, averaged; // weights of the previous frame
  double weight = 0;
  for (int t = 0; t < frames; ++t) {
    const double h = light(dynamic, t), control = 0.5 * h;
    const Frame now = draw(random, h, samples_a_frame);
    const double found = now.covariance / now.variance_g;
    const std::array<double, 6> residual = {now.f,
                                            now.f - single.value_or(0) * now.g,
                                            now.f - averaged.value_or(0) * now.g,
                                            now.f - weight * now.g,
                                            now.f - weight * control,
                                            now.f - best * now.g};
    for (size_t k = 0; k < residual.size(); ++k) {
      spread[k].add(residual[k], eta_residual);
      if (t >= first_counted) mean[k] += std::sqrt(spread[k].variance) / (frames - first_counted);
    }
    moments.add(now.f, now.g, eta_covariance);
    weight = moments.variance_g > 0 ? moments.covariance / moments.variance_g : 0;
    averaged = averaged ? *averaged + eta_covariance * (found - *averaged) : found;
    single = found;
  }
  return mean;
}

double sampled_control_weight(bool dynamic, uint32_t samples, uint64_t seed) {
  Uniform random{seed};
  if (!dynamic) {
    const Frame all = draw(random, 1, samples);
    return all.covariance / all.variance_g;
  }
  double f = 0, g = 0, fg = 0, gg = 0;
  for (int t = 0; t < frames; ++t) {
    const Frame now = draw(random, light(true, t), samples);
    f += now.f / frames;
    g += now.g / frames;
    fg += now.f * now.g / frames;
    gg += now.g * now.g / frames;
  }
  return (fg - f * g) / (gg - g * g);
}

} // namespace dermis::tools
