// Tests closed forms and the sampler against tabulated values. The functions' headers have the
// equation numbers.

#include "integration/tools/command/bench/truth/properties.hpp"
#include "integration/tools/references/analytic.hpp"
#include "passes/common/profiles/burley_profile.hpp"
#include "passes/common/reference/planar.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace dermis::tools {
namespace {

using std::numbers::pi;
constexpr double six_digits = 6e-7; // tabulated values are rounded to six digits
constexpr double cut_digits = 1e-6; // tabulated values are truncated to six digits

struct Rows {
  std::vector<PropertyRow> all;

  void add(std::string property, double expected, double measured, double tolerance) {
    all.push_back({std::move(property), "formula", expected, measured, tolerance});
  }
};

void add_profile(Rows& rows) {
  constexpr double r[] = {0.5, 1, 2, 3, 5, 10},
                   cdf[] = {0.213506, 0.370632, 0.581103, 0.711644, 0.856659, 0.973233};
  for (size_t i = 0; i < std::size(r); ++i)
    rows.add(fmt::format("cdf({} d)", r[i]), cdf[i], subsurface::burley_cdf(r[i], 1), six_digits);
  constexpr double xi[] = {0.5, 0.9, 0.99, 0.997, 0.999},
                   radius[] = {1.55218, 6.06223, 12.95264, 16.56440, 19.86022};
  for (size_t i = 0; i < std::size(xi); ++i)
    rows.add(fmt::format("inverse cdf({})", xi[i]), radius[i],
             subsurface::burley_inverse_survival(1 - xi[i], 1), 6e-6);
  rows.add("scaling s(A = 0.8), dmfp", 8.3797, subsurface::burley_scaling_dmfp(0.8), 5e-5);
  rows.add("scaling s(A = 0.33), dmfp", 3.5, subsurface::burley_scaling_dmfp(0.33), 1e-12);
  rows.add("scaling s(A = 1), dmfp", 23.6511, subsurface::burley_scaling_dmfp(1), 6e-5);
}

// Midpoint rule over the survival u; the tail is clamped at 2^-24.
void add_sampler(Rows& rows) {
  constexpr int n = 2000000;
  double r1 = 0, r2 = 0, exact1 = 0, exact2 = 0, weight = 0, furthest = 0;
  for (int i = 0; i < n; ++i) {
    const double u = (i + 0.5) / n;
    const double w = subsurface::burley_sample_weight(u),
                 r = subsurface::burley_sample_survival(u, 1);
    const double exact = subsurface::burley_inverse_survival(u, 1);
    weight += w / n;
    r1 += w * r / n;
    r2 += w * r * r / n;
    exact1 += exact / n;
    exact2 += exact * exact / n;
    furthest = std::max(furthest, std::abs(r / exact - 1));
  }
  rows.add("E[r] of the exact inverse, in d", 2.5, exact1, 2.5e-3);
  rows.add("E[r^2] of the exact inverse, in d^2", 14, exact2, 0.014); // 0.1 %
  rows.add("mean weight of the sampler", 1, weight, 1e-5);
  rows.add("E[w r] of the sampler, in d", 2.5, r1, 2.5e-3);
  rows.add("E[w r^2] of the sampler, in d^2", 14, r2, 0.014);
  rows.add("largest relative error of the sampler's radius", 0, furthest, 0.0052);
}

void add_plane(Rows& rows) {
  constexpr double x[] = {0.1, 0.25, 0.5, 1, 2, 4, 8};
  constexpr double edge[] = {0.563178, 0.621756, 0.689769, 0.776990, 0.870563, 0.947619, 0.989248};
  for (size_t i = 0; i < std::size(x); ++i)
    rows.add(fmt::format("edge at {} d", x[i]), edge[i], subsurface::burley_edge(x[i], 1),
             six_digits);
  constexpr double k[] = {0.1, 0.5, 1, 2, 5},
                   mtf[] = {0.967129, 0.639632, 0.413948, 0.235103, 0.098918};
  for (size_t i = 0; i < std::size(k); ++i)
    rows.add(fmt::format("contrast of a sinusoid, k d = {}", k[i]), mtf[i],
             subsurface::burley_mtf(k[i], 1), six_digits);
  rows.add("centre of a disc, radius 2 d", 0.581103, subsurface::burley_disc(0, 2, 1), six_digits);
  rows.add("centre of a Gaussian, s = 0.5 d", 0.247374, subsurface::burley_gaussian_centre(0.5, 1),
           six_digits);
  rows.add("centre of a Gaussian, s = 2 d", 0.605886, subsurface::burley_gaussian_centre(2, 1),
           six_digits);
}

// Tests the fraction of a pixel's light that stays in the pixel at d = 3 px, and the radii of
// equivalent discs.
void add_centre(Rows& rows) {
  constexpr double d = 3;
  const double exact = subsurface::planar_weight(1, 1, 0, 0, {d, d, d})[0];
  // polar quadrature, 1e5 steps
  rows.add("fraction that stays in a pixel, d = 3 px", 0.0879216, exact, six_digits / 10);
  rows.add("disc of equal area, relative to that", 1,
           subsurface::burley_cdf(std::sqrt(1 / pi), d) / exact, 0.006);
  rows.add("disc with half the diagonal as radius, relative to that", 1.24,
           subsurface::burley_cdf(std::sqrt(0.5), d) / exact, 0.006);
}

// Chords of a sphere: remaining fraction of a harmonic of degree l, by Simpson's rule.
void add_sphere(Rows& rows) {
  constexpr double radius = 5; // in d
  constexpr double tabulated[] = {0.973233, 0.788511, 0.635578, 0.525471, 0.445382};
  const auto legendre = [](int l, double x) {
    double before = 1, now = x;
    if (l == 0) return 1.0;
    for (int i = 2; i <= l; ++i) {
      const double next = ((2 * i - 1) * x * now - (i - 1) * before) / i;
      before = now;
      now = next;
    }
    return now;
  };
  constexpr int steps = 20000; // even
  for (int l = 0; l < 5; ++l) {
    double sum = 0;
    for (int i = 0; i <= steps; ++i) {
      const double r = 2 * radius * i / steps;
      const double weight = i == 0 || i == steps ? 1 : i % 2 == 1 ? 4 : 2;
      sum += weight * subsurface::burley_pdf(r, 1) * legendre(l, 1 - r * r / (2 * radius * radius));
    }
    rows.add(fmt::format("harmonic {} on a sphere of radius 5 d", l), tabulated[l],
             sum * 2 * radius / steps / 3, cut_digits);
  }
}

} // namespace

bool PropertyRow::holds() const {
  return !tolerance || std::abs(measured - expected) <= *tolerance; // NaN does not hold
}

std::vector<PropertyRow> formula_properties() {
  Rows rows;
  add_profile(rows);
  add_sampler(rows);
  add_plane(rows);
  add_centre(rows);
  add_sphere(rows);
  return rows.all;
}

} // namespace dermis::tools
