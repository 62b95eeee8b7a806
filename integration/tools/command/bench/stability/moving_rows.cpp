// Compares exponential moving averages that are stored as half floats with fp64, over `updates`
// updates.
#include "integration/tools/command/bench/stability/rows.hpp"

#include "framegraph/model/splitmix.hpp"
#include "integration/examples/demo_engine/pixel_format.hpp"
#include "integration/tools/references/guidance.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::tools {
namespace {

constexpr double half_step = 0x1p-11; // largest relative error of a half float

float as_half(double value) {
  return demo::float_from_half(demo::half_from_float(static_cast<float>(value)));
}

// Compares mean and standard deviation in half floats with fp64, for a value with ±2 % noise.
// Error: relative, of the standard deviation, which controls the number of samples, over the last
// tenth.
StabilityRow moving(std::string name, double level, uint64_t updates) {
  constexpr double eta = 0.2; // GuidanceSettings::eta
  subsurface::MovingVariance exact;
  float mean = 0, deviation = 0;
  SplitMix64 random{7};
  double squares = 0, exact_squares = 0;
  bool finite = true;
  for (uint64_t i = 0; i < updates; ++i) {
    const double noise = static_cast<double>(random.next() >> 11) * 0x1p-53;
    const double x = level * (1 + 0.02 * (2 * noise - 1));
    exact.add(x, eta);
    if (i == 0) mean = as_half(x);
    const double step = x - double(mean);
    mean = as_half(double(mean) + eta * step);
    deviation =
        as_half(std::sqrt((1 - eta) * (double(deviation) * double(deviation) + eta * step * step)));
    finite = finite && std::isfinite(mean) && std::isfinite(deviation);
    if (i >= updates - updates / 10) {
      squares += double(deviation) * double(deviation);
      exact_squares += exact.variance;
    }
  }
  // Each rounding of the mean adds at most half a step to the next deviation, which is about 1.1 %
  // of the mean.
  StabilityRow made =
      formula_row(std::move(name), std::abs(std::sqrt(squares / exact_squares) - 1), 0.02, finite);
  made.frames = updates;
  return made;
}

// Simulates the closed loop of sampling: values stored in half floats determine the number of
// samples, which determines the stored values. Compares with fp64 for the same random numbers.
// Error: relative, of the mean number of samples.
StabilityRow closed_loop(std::string name, double spread, uint64_t updates) {
  struct Loop {
    subsurface::MovingVariance moments;
    double mean_count = 0, samples = 0;
    int count = 0;
  };
  const subsurface::GuidanceSettings settings;
  Loop kept, exact;
  const auto frame = [&](Loop& loop, double draw, bool halves) {
    const auto store = [&](double value) { return halves ? double(as_half(value)) : value; };
    const bool begun = loop.moments.begun;
    loop.count =
        begun ? subsurface::clamped_samples(
                    subsurface::required_samples(loop.moments.variance, loop.mean_count, settings),
                    settings)
              : static_cast<int>(settings.min_samples);
    loop.samples += loop.count;
    loop.moments.add(1 + spread * draw / std::sqrt(double(loop.count)), settings.eta);
    const double deviation = store(std::sqrt(loop.moments.variance));
    loop.moments.variance = deviation * deviation;
    loop.moments.mean = store(loop.moments.mean);
    loop.mean_count =
        store(begun ? loop.mean_count + settings.eta * (loop.count - loop.mean_count) : loop.count);
  };
  SplitMix64 random{11};
  for (uint64_t i = 0; i < updates; ++i) {
    const double even = static_cast<double>(random.next() >> 11) * 0x1p-53;
    const double draw = std::sqrt(12.0) * (even - 0.5); // variance 1
    frame(kept, draw, true);
    frame(exact, draw, false);
  }
  StabilityRow made = formula_row(std::move(name), std::abs(kept.samples / exact.samples - 1), 0.02,
                                  std::isfinite(kept.samples));
  made.frames = updates;
  return made;
}

// The mean must follow a step to within (1 - eta) / eta half steps of a half float, and not freeze.
StabilityRow following(std::string name, double eta, double bound) {
  float mean = as_half(0);
  for (uint32_t i = 0; i < 10000; ++i)
    mean = as_half(double(mean) + eta * (1 - double(mean)));
  StabilityRow made = formula_row(std::move(name), std::abs(1 - double(mean)), bound);
  made.frames = 10000;
  return made;
}

// For a value that alternates by one float step, the deviation must match the float step and never
// stem from a negative variance. Error: of mean and deviation, in units of the level.
StabilityRow steady(std::string name, double level, uint64_t updates) {
  constexpr double eta = 0.2;
  const double next = std::nextafter(static_cast<float>(level), HUGE_VALF);
  subsurface::MovingVariance moments;
  double worst = 0;
  bool finite = true;
  for (uint64_t i = 0; i < updates; ++i) {
    moments.add(i % 2 == 0 ? level : next, eta);
    const double deviation = as_half(std::sqrt(moments.variance));
    moments.mean = as_half(moments.mean);
    moments.variance = deviation * deviation;
    finite = finite && std::isfinite(deviation) && deviation >= 0;
    worst = std::max({worst, deviation / level, std::abs(moments.mean / level - 1)});
  }
  StabilityRow made = formula_row(std::move(name), worst, half_step, finite);
  made.frames = updates;
  return made;
}

using Store = double (*)(double);
double in_half(double value) {
  return as_half(value);
}
double in_float(double value) {
  return static_cast<float>(value);
}

// Compares the control's weight as stored by shaders/afis/subsurface_guided.comp (weight, deviation
// and both means) with fp64. Half of the control's change, of at most `swing`, is also in the
// controlled value. Error: difference of the weights over the last tenth.
StabilityRow control_over_frames(std::string name, double swing, double eta, double eps_alpha,
                                 Store store) {
  constexpr uint64_t frames = 36000; // ten minutes at 60 Hz
  subsurface::MovingCovariance exact, kept;
  SplitMix64 random{13};
  const auto noise = [&] { return static_cast<double>(random.next() >> 11) * 0x1p-52 - 1; };
  double error = 0;
  bool finite = true;
  for (uint64_t i = 0; i < frames; ++i) {
    const double own = swing * noise(), f = 1 + own / 2 + 0.03 * noise(), g = 1 + own;
    exact.add(f, g, eta);
    kept.add(f, g, eta);
    const double weight = store(kept.variance_g > 0 ? kept.covariance / kept.variance_g : 1);
    const double deviation = store(std::sqrt(kept.variance_g));
    kept.variance_g = deviation * deviation;
    kept.covariance = weight * kept.variance_g;
    kept.mean_f = store(kept.mean_f);
    kept.mean_g = store(kept.mean_g);
    const double found = subsurface::control_weight(kept, eps_alpha);
    // at most 1 + mean_f / mean_g
    finite = finite && std::isfinite(found) && found >= 0 && found <= 2.1;
    if (i >= frames - frames / 10)
      error = std::max(error, std::abs(found - subsurface::control_weight(exact, eps_alpha)));
  }
  StabilityRow made = formula_row(std::move(name), error, 0.02, finite);
  made.frames = frames;
  return made;
}

// Uniform light leaves no variance and the minimum number of samples; a change of light must be
// detected in the next frame. Error: minimum over actual number of samples.
StabilityRow awakening(std::string name) {
  const subsurface::GuidanceSettings settings;
  subsurface::MovingVariance moments;
  double mean_count = settings.min_samples;
  int count = 0;
  constexpr int even = 600;
  for (int i = 0; i < even + 2; ++i) {
    count = subsurface::clamped_samples(
        subsurface::required_samples(moments.variance, mean_count, settings), settings);
    moments.add(i < even ? 1 : 0.5, settings.eta);
    const double deviation = as_half(std::sqrt(moments.variance));
    moments.variance = deviation * deviation;
    mean_count = as_half(mean_count + settings.eta * (count - mean_count));
  }
  StabilityRow made = formula_row(std::move(name), settings.min_samples / count, 0.5);
  made.frames = even + 2;
  return made;
}

} // namespace

std::vector<StabilityRow> moving_rows(uint64_t updates) {
  return {moving("guidance_updates_6e4", 6e4, updates),
          moving("guidance_updates_bright", 1000, updates),
          moving("guidance_updates_at_1", 1, updates),
          moving("guidance_updates_faint", 1e-3, updates),
          moving("guidance_updates_1e-4", 1e-4, updates),
          steady("guidance_updates_within_a_step", 1000, updates),
          closed_loop("closed_loop_of_few_samples", 0.03, updates),
          closed_loop("closed_loop_of_samples", 0.06, updates),
          awakening("variance_of_0_wakes_up"),
          control_over_frames("control_weight_of_ocv", 0.5, 0.005, 5e-3, in_half),
          control_over_frames("control_weight_of_ocv_trembling", 0.1, 0.005, 5e-3, in_half),
          control_over_frames("control_weight_of_ocv_seed", 0.5, 1e-6, 1e-6, in_float),
          following("half_mean_follows_eta_0.2", 0.2, half_step * 4),
          following("half_mean_follows_eta_0.05", 0.05, half_step * 19),
          following("half_mean_follows_eta_0.01", 0.01, half_step * 99)};
}

} // namespace dermis::tools
