// Closed forms at the limits of their ranges and beyond.
#include "integration/tools/command/bench/stability/rows.hpp"

#include "framegraph/model/splitmix.hpp"
#include "integration/tools/references/guidance.hpp"
#include "passes/common/profiles/burley_profile.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <span>

namespace dermis::tools {
namespace {

constexpr double no_number = std::numeric_limits<double>::quiet_NaN();
// Radius of the minimum survival, 2^-24, in units of d, by the approximate inverse.
constexpr double furthest_d = 49.1;

// Error: distance of a radius outside [0, 49 d], over all inverses.
StabilityRow radii(std::string name, std::span<const double> survivals) {
  double error = 0;
  bool finite = true;
  for (const double survival : survivals) {
    for (const double r : {subsurface::burley_inverse_survival(survival, 1),
                           subsurface::burley_sample_survival(survival, 1),
                           subsurface::burley_approximate_survival(survival, 1)}) {
      finite = finite && std::isfinite(r);
      error = std::max({error, -r, r - furthest_d});
    }
    for (const double weight : {subsurface::burley_sample_weight(survival),
                                subsurface::burley_approximate_weight(survival)})
      finite = finite && std::isfinite(weight) && weight >= 0;
  }
  return formula_row(std::move(name), error, 0, finite);
}

StabilityRow radii(std::string name, double survival) {
  return radii(std::move(name), std::span(&survival, 1));
}

// Returns random bit patterns as floats.
std::vector<double> any_floats() {
  constexpr size_t many = 1 << 16;
  std::vector<double> values;
  SplitMix64 random{3};
  for (size_t i = 0; i < many; ++i)
    values.push_back(std::bit_cast<float>(static_cast<uint32_t>(random.next())));
  return values;
}

// At large radii the exact inverse must return the radius of its argument, without clamping. Error:
// relative.
StabilityRow tail(std::string name, double r) {
  const double survival = std::exp(-r) / 4 + 3 * std::exp(-r / 3) / 4;
  const double density = subsurface::burley_pdf(r, 1);
  return formula_row(std::move(name),
                     std::abs(subsurface::burley_inverse_survival(survival, 1) / r - 1), 1e-12,
                     std::isfinite(density) && density > 0);
}

// Beyond the largest sampled radius densities must be finite and monotonically fall to 0, also for
// a channel with a thousandth of d. Error: largest increase.
StabilityRow beyond_tail(std::string name, double from, double to) {
  double error = 0;
  bool finite = true;
  for (const double d : {1.0, 1e-3})
    for (double r = from; r < to; r *= 1.25) {
      const double here = subsurface::burley_pdf(r, d),
                   further = subsurface::burley_pdf(1.25 * r, d);
      finite = finite && std::isfinite(here) && here >= 0;
      error = std::max(error, further - here);
    }
  return formula_row(std::move(name), error, 0, finite);
}

StabilityRow albedo(std::string name, double albedo, double clamped) {
  double error = 0;
  for (const auto& scaling :
       {subsurface::burley_scaling_dmfp, subsurface::burley_scaling_searchlight,
        subsurface::burley_scaling_diffuse})
    error = std::max(error, std::abs(scaling(albedo) - scaling(clamped)));
  return formula_row(std::move(name), error, 0);
}

StabilityRow dmfp(std::string name, double dmfp, double d) {
  return formula_row(std::move(name), std::abs(subsurface::burley_d_from_dmfp(dmfp, 0.33) - d),
                     1e-40);
}

StabilityRow weight_of(std::string name, const subsurface::MovingCovariance& moments,
                       double expected, double bound) {
  return formula_row(std::move(name),
                     std::abs(subsurface::control_weight(moments, 1e-6) - expected), bound);
}

} // namespace

StabilityRow formula_row(std::string name, double error, double bound, bool finite) {
  StabilityRow made;
  made.name = std::move(name);
  made.technique = "formula";
  made.max_abs_error = error;
  made.bound = bound;
  made.nonfinite_pixels = finite && std::isfinite(error) ? 0 : 1;
  return made;
}

std::vector<StabilityRow> formula_rows() {
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
          radii("xi_any_bits", any_floats()),
          tail("tail_at_30_d", 30),
          tail("tail_at_49_d", 49),
          beyond_tail("tail_beyond_80_d", 80, 1e6),
          albedo("albedo_-1", -1, 0),
          albedo("albedo_2", 2, 1),
          albedo("albedo_nan", no_number, 0.33),
          dmfp("dmfp_0", 0, 0),
          dmfp("dmfp_1e-30", 1e-30, 1e-30 / 3.5),
          dmfp("dmfp_negative", -1, 0),
          dmfp("dmfp_nan", no_number, 0),
          weight_of("control_weight_dark", dark, 1, 0),
          weight_of("control_weight_faint", tiny, 1, 1e-6),
          weight_of("control_weight_first_flash", flash, 1, 1e-6),
          weight_of("control_weight_opposed", against, 0, 0)};
}

} // namespace dermis::tools
