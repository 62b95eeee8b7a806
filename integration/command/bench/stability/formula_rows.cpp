// Closed forms at the ends of their ranges, and moving values that are rounded a million times.
#include "integration/command/bench/stability/rows.hpp"

#include "framegraph/model/splitmix.hpp"
#include "integration/demo_engine/pixel_format.hpp"
#include "passes/subsurface/burley_profile.hpp"
#include "passes/subsurface/guidance/guidance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dermis::tools {
namespace {

constexpr double no_number = std::numeric_limits<double>::quiet_NaN();
constexpr double furthest_d =
    49.1; // radius of the smallest survival, 2^-24, in d, by the approximate inverse
constexpr double half_step = 0x1p-11; // largest relative error of a half float

StabilityRow row(std::string name, double error, double bound, bool finite = true) {
  StabilityRow made;
  made.name = std::move(name);
  made.technique = "formula";
  made.max_abs_error = error;
  made.bound = bound;
  made.nonfinite_pixels = finite && std::isfinite(error) ? 0 : 1;
  return made;
}

// Error: by how much a radius leaves [0, 49 d], over all inverses.
StabilityRow radii(std::string name, double survival) {
  double error = 0;
  bool finite = true;
  for (const double r :
       {subsurface::burley_inverse_survival(survival, 1), subsurface::burley_sample_survival(survival, 1),
        subsurface::burley_approximate_survival(survival, 1)}) {
    finite = finite && std::isfinite(r);
    error = std::max({error, -r, r - furthest_d});
  }
  for (const double weight :
       {subsurface::burley_sample_weight(survival), subsurface::burley_approximate_weight(survival)})
    finite = finite && std::isfinite(weight) && weight >= 0;
  return row(std::move(name), error, 0, finite);
}

StabilityRow albedo(std::string name, double albedo, double clamped) {
  double error = 0;
  for (const auto& scaling : {subsurface::burley_scaling_dmfp, subsurface::burley_scaling_searchlight,
                              subsurface::burley_scaling_diffuse})
    error = std::max(error, std::abs(scaling(albedo) - scaling(clamped)));
  return row(std::move(name), error, 0);
}

StabilityRow dmfp(std::string name, double dmfp, double d) {
  return row(std::move(name), std::abs(subsurface::burley_d_from_dmfp(dmfp, 0.33) - d), 1e-40);
}

StabilityRow weight(std::string name, const subsurface::MovingCovariance& moments, double expected,
                    double bound) {
  return row(std::move(name), std::abs(subsurface::control_weight(moments, 1e-6) - expected), bound);
}

float as_half(double value) {
  return demo::float_from_half(demo::half_from_float(static_cast<float>(value)));
}

// Mean and standard deviation in half floats beside the twin in fp64, of a value with ±2 % noise; error:
// relative, of the standard deviation, which is what sample numbers go by, over the last tenth.
StabilityRow moving(std::string name, double level, uint64_t updates) {
  constexpr double eta = 0.2; // GuidanceSettings::eta
  subsurface::MovingVariance twin;
  float mean = 0, deviation = 0;
  SplitMix64 random{7};
  double squares = 0, twin_squares = 0;
  bool finite = true;
  for (uint64_t i = 0; i < updates; ++i) {
    const double noise = static_cast<double>(random.next() >> 11) * 0x1p-53;
    const double x = level * (1 + 0.02 * (2 * noise - 1));
    twin.add(x, eta);
    if (i == 0) mean = as_half(x);
    const double step = x - double(mean);
    mean = as_half(double(mean) + eta * step);
    deviation = as_half(std::sqrt((1 - eta) * (double(deviation) * double(deviation) + eta * step * step)));
    finite = finite && std::isfinite(mean) && std::isfinite(deviation);
    if (i >= updates - updates / 10) {
      squares += double(deviation) * double(deviation);
      twin_squares += twin.variance;
    }
  }
  // Each rounding of the mean adds at most half a step to the next deviation, of 2 % of the mean or more.
  StabilityRow made = row(std::move(name), std::abs(std::sqrt(squares / twin_squares) - 1), 0.02, finite);
  made.frames = updates;
  return made;
}

// Samples of a pixel whose spread they are to bring down to the target, in a closed loop: what is kept in
// half floats says how many are taken, and those what is kept. Beside it the twin in fp64 with draws of the
// same. Error: relative, of the mean number of samples.
StabilityRow closed_loop(std::string name, double spread, uint64_t updates) {
  struct Loop {
    subsurface::MovingVariance moments;
    double mean_count = 0, samples = 0;
    int count = 0;
  };
  const subsurface::GuidanceSettings settings;
  Loop kept, twin;
  const auto frame = [&](Loop& loop, double draw, bool halves) {
    const auto store = [&](double value) { return halves ? double(as_half(value)) : value; };
    const bool begun = loop.moments.begun;
    loop.count =
        begun ? subsurface::clamped_samples(
                    subsurface::wanted_samples(loop.moments.variance, loop.mean_count, settings), settings)
              : static_cast<int>(settings.least);
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
    frame(twin, draw, false);
  }
  StabilityRow made =
      row(std::move(name), std::abs(kept.samples / twin.samples - 1), 0.02, std::isfinite(kept.samples));
  made.frames = updates;
  return made;
}

// A frozen mean would stay where it is: it must follow a step to within a step of a half float over (1 - eta)
// / eta.
StabilityRow following(std::string name, double eta, double bound) {
  float mean = as_half(0);
  for (uint32_t i = 0; i < 10000; ++i)
    mean = as_half(double(mean) + eta * (1 - double(mean)));
  StabilityRow made = row(std::move(name), std::abs(1 - double(mean)), bound);
  made.frames = 10000;
  return made;
}

} // namespace

std::vector<StabilityRow> formula_rows(uint64_t updates) {
  subsurface::MovingCovariance dark, tiny, flash, against;
  for (int i = 0; i < 100; ++i) {
    dark.add(0, 0, 0.2);
    tiny.add(i % 2 * 1e-12, i % 2 * 1e-12, 0.2);
    flash.add(i == 99 ? 1 : 0, i == 99 ? 1 : 0, 0.2);
    against.add(i % 2 * 1.0, 1.0 - i % 2, 0.2);
  }
  return {radii("xi_0", 1),
          radii("xi_2^-24", 1 - 0x1p-24),
          radii("xi_1-2^-24", 0x1p-24),
          radii("xi_1", 0),
          radii("xi_beyond_1", -0.25),
          albedo("albedo_-1", -1, 0),
          albedo("albedo_2", 2, 1),
          albedo("albedo_nan", no_number, 0.33),
          dmfp("dmfp_0", 0, 0),
          dmfp("dmfp_1e-30", 1e-30, 1e-30 / 3.5),
          dmfp("dmfp_negative", -1, 0),
          dmfp("dmfp_nan", no_number, 0),
          weight("control_weight_dark", dark, 1, 0),
          weight("control_weight_faint", tiny, 1, 1e-6),
          weight("control_weight_first_flash", flash, 1, 1e-6),
          weight("control_weight_opposed", against, 0, 0),
          moving("guidance_updates_bright", 1000, updates),
          moving("guidance_updates_at_1", 1, updates),
          moving("guidance_updates_faint", 1e-3, updates),
          closed_loop("closed_loop_of_few_samples", 0.03, updates),
          closed_loop("closed_loop_of_samples", 0.06, updates),
          following("half_mean_follows_eta_0.2", 0.2, half_step * 4),
          following("half_mean_follows_eta_0.05", 0.05, half_step * 19)};
}

} // namespace dermis::tools
