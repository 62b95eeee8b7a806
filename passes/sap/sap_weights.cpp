#include "passes/sap/sap_weights.hpp"

#include "passes/common/nnls.hpp"
#include "passes/common/reference/planar.hpp"
#include "passes/common/sinc.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dermis::subsurface {

namespace {

using std::numbers::pi;

// Frequencies of the fit in cycles per pixel: rings from far below the widest kernel to the corner
// of the band, each at a few angles of the first octant.
constexpr size_t ring_count = 72, angle_count = 5;
constexpr double sap_min_frequency = 1.0 / 4096, sap_max_frequency = 0.5;
// Light on surfaces has a power spectrum near f^-2.5 (dead leaves, edges). Rings are equal steps in
// log f, whose area grows with f^2.
constexpr double spectrum_exponent = -2.5;
// Above this d (pixels), the kernel's transfer function comes from the closed form: its spectrum
// times the pixel's sinc, with the aliases of sampling at pixel centres.
constexpr double closed_form_from_d = 3;
constexpr int folded_copies = 4; // on each side; the others add less than 1e-4
// Weight that holds the sum of the weights at 1, against a total weight of 1 for all frequencies.
constexpr double sum_weight = 1e3;

struct Frequency {
  double x, y, weight; // weight of the squared error; the sum is 1
};

std::vector<Frequency> make_frequencies(const SapShape& shape) {
  std::vector<Frequency> list;
  // The other octant of a quadrant is a mirror image if pixels are square.
  const bool square = shape.side(0) == shape.side(1);
  double total = 0;
  for (size_t ring = 0; ring < ring_count; ++ring) {
    const double f = sap_min_frequency * std::pow(sap_max_frequency / sap_min_frequency,
                                                  (double(ring) + 0.5) / double(ring_count));
    for (size_t angle = 0; angle < angle_count; ++angle) {
      const double theta = (square ? 0.25 : 0.5) * pi * (double(angle) + 0.5) / double(angle_count);
      const double x = f * std::cos(theta) * shape.side(0), y = f * std::sin(theta) * shape.side(1);
      if (std::max(x, y) > sap_max_frequency) continue;
      list.push_back({x, y, std::pow(f, 2 + spectrum_exponent)});
      total += list.back().weight;
    }
  }
  for (Frequency& f : list)
    f.weight /= total;
  return list;
}

// Return the transfer functions of the step to a level and back, and of a level's tent.
double chain_step(const Frequency& f, const SapShape& shape, uint32_t level, int power) {
  double product = 1;
  for (const uint32_t axis : {0u, 1u})
    if (shape.halves(axis, level))
      product *= std::cos(pi * (axis == 0 ? f.x : f.y) * shape.spacing(axis, level - 1));
  return std::pow(product, power);
}
double tent_at(const Frequency& f, const SapShape& shape, uint32_t level) {
  double product = 1;
  for (const uint32_t axis : {0u, 1u}) {
    const auto k = shape.tent(axis, level);
    const double w = 2 * pi * (axis == 0 ? f.x : f.y) * shape.spacing(axis, level);
    product *= k[0] + 2 * k[1] * std::cos(w) + 2 * k[2] * std::cos(2 * w);
  }
  return product;
}

// Transfer function of a level read through a cubic B-spline at all pixels: sinc^4 of the spacing,
// with the aliases of sampling at pixels.
double spline_axis(double f, double spacing) {
  double sum = 0;
  for (int m = -folded_copies; m <= folded_copies; ++m)
    sum += std::pow(sinc((f + m) * spacing), 4);
  return sum;
}

SapWeights basis_at(const Frequency& f, SapVariant variant, const SapShape& shape) {
  const bool plain = variant == SapVariant::plain;
  const bool half = variant == SapVariant::half;
  SapWeights basis{1, plain  ? spline_axis(f.x, 1) * spline_axis(f.y, 1)
                      : half ? 0
                             : tent_at(f, shape, 0)};
  double chain = 1;
  for (uint32_t level = 1; level < sap_level_count; ++level) {
    chain *= chain_step(f, shape, level, plain ? 3 : half && level == 1 ? 4 : 6);
    double filter = 1;
    if (plain)
      filter =
          spline_axis(f.x, shape.spacing(0, level)) * spline_axis(f.y, shape.spacing(1, level));
    else if (level <= sap_last_tent(variant))
      filter = tent_at(f, shape, level);
    basis[level + 1] = chain * filter;
  }
  return basis;
}

// Terms of the closed form at a frequency and its aliases; independent of the shape.
struct Folded {
  static constexpr size_t copies = 2 * folded_copies + 1; // per axis
  std::array<double, copies> sinc_x, sinc_y;
  std::array<std::array<double, copies>, copies> k; // by y, x: radians per pixel
};

std::vector<Folded> fold(const std::vector<Frequency>& frequencies, const SapShape& shape) {
  std::vector<Folded> all(frequencies.size());
  for (size_t i = 0; i < all.size(); ++i)
    for (int n = -folded_copies; n <= folded_copies; ++n) {
      const auto at = static_cast<size_t>(n + folded_copies);
      const Frequency& f = frequencies[i];
      all[i].sinc_x[at] = sinc(f.x + n);
      all[i].sinc_y[at] = sinc(f.y + n);
      for (int m = -folded_copies; m <= folded_copies; ++m)
        all[i].k[at][static_cast<size_t>(m + folded_copies)] =
            2 * pi * std::hypot((f.x + m) / shape.side(0), (f.y + n) / shape.side(1));
    }
  return all;
}

// Returns the reference's transfer function at all frequencies, from the summed pixel-integrated
// kernel or its closed form.
std::vector<double> target_of(const std::vector<Frequency>& frequencies,
                              const std::vector<Folded>& folded, const ChannelShape& shape,
                              const SapShape& pixel) {
  std::vector<double> target;
  if (shape.d >= closed_form_from_d) {
    for (const Folded& f : folded) {
      double sum = 0;
      for (size_t n = 0; n < Folded::copies; ++n)
        for (size_t m = 0; m < Folded::copies; ++m)
          sum += shape_transfer(shape, f.k[n][m]) * f.sinc_x[m] * f.sinc_y[n];
      target.push_back(sum);
    }
    return target;
  }
  const double radius = shape_reach(shape) + std::sqrt(0.5);
  const double side_x = pixel.side(0), side_y = pixel.side(1);
  const auto reach = static_cast<size_t>(std::ceil(radius / std::min(side_x, side_y))) + 1;
  std::vector<double> kernel((reach + 1) * (reach + 1));
  double total = 0;
  for (size_t y = 0; y <= reach; ++y)
    for (size_t x = 0; x <= reach; ++x) {
      const double copies = (x > 0 ? 2 : 1) * (y > 0 ? 2 : 1); // the other quadrants
      total += kernel[y * (reach + 1) + x] =
          copies * planar_weight(side_x, side_y, static_cast<int64_t>(x), static_cast<int64_t>(y),
                                 ProfileShape{shape, {}, {}}, radius)[0];
    }
  std::vector<double> wave(reach + 1);
  for (const Frequency& f : frequencies) {
    for (size_t x = 0; x <= reach; ++x)
      wave[x] = std::cos(2 * pi * f.x * double(x));
    double sum = 0;
    for (size_t y = 0; y <= reach; ++y) {
      double row = 0;
      for (size_t x = 0; x <= reach; ++x)
        row += kernel[y * (reach + 1) + x] * wave[x];
      sum += row * std::cos(2 * pi * f.y * double(y));
    }
    target.push_back(sum / total);
  }
  return target;
}

// The least-squares problem of a variant; independent of the shape.
struct Problem {
  SapVariant variant;
  std::vector<SapWeights> basis = {}; // by frequency
  NormalEquations<sap_weight_count> equations = {};
  SapWeights ones = {}; // 1 for each weight that exists
};

Problem make_problem(const std::vector<Frequency>& frequencies, SapVariant variant,
                     const SapShape& shape) {
  Problem problem{variant};
  for (const Frequency& f : frequencies) {
    problem.basis.push_back(basis_at(f, variant, shape));
    problem.equations.add_row(problem.basis.back(), f.weight);
  }
  problem.ones.fill(1);
  if (variant == SapVariant::half) problem.ones[1] = 0;
  problem.equations.add_row(problem.ones, sum_weight);
  return problem;
}

void solve_node(const Problem& problem, const std::vector<Frequency>& frequencies,
                const std::vector<double>& target, double direct, SapNode& node) {
  SapWeights right{};
  for (size_t i = 0; i < frequencies.size(); ++i)
    for (uint32_t j = 0; j < sap_weight_count; ++j)
      right[j] += frequencies[i].weight * target[i] * problem.basis[i][j];
  for (uint32_t j = 0; j < sap_weight_count; ++j)
    right[j] += sum_weight * problem.ones[j];
  node.weights = solve_non_negative(problem.equations, right);
  double sum = 0;
  for (const double w : node.weights)
    sum += w;
  for (double& w : node.weights)
    w /= sum;
  double squares = 0;
  for (size_t i = 0; i < frequencies.size(); ++i) {
    double error = -target[i];
    for (uint32_t j = 0; j < sap_weight_count; ++j)
      error += node.weights[j] * problem.basis[i][j];
    squares += frequencies[i].weight * error * error;
  }
  node.residual = std::sqrt(squares);
  for (double& w : node.weights)
    w *= 1 - direct;
  node.weights[0] += direct;
}

} // namespace

double SapShape::side(uint32_t axis) const {
  return std::exp2((double(halvings) + log2_aspect) * (axis == 0 ? 0.5 : -0.5));
}
double SapShape::spacing(uint32_t axis, uint32_t level) const {
  const uint32_t first = axis == 0 ? halvings : 0;
  return std::ldexp(1.0, static_cast<int>(level > first ? level - first : 0));
}
std::array<double, 3> SapShape::tent(uint32_t axis, uint32_t level) const {
  std::array<double, 2> before{}, side{}; // variance of the steps to the level; squared side
  for (const uint32_t k : {0u, 1u}) {
    const double square = spacing(k, level) * spacing(k, level);
    before[k] = 0.5 - 0.5 / square; // 3/2 for each step, in squares of its finer spacing
    side[k] = square * this->side(k) * this->side(k);
  }
  // (before[0] + x) side[0] = (before[1] + 1 - x) side[1]
  const double wide = ((before[1] + 1) * side[1] - before[0] * side[0]) / (side[0] + side[1]);
  const bool three_taps = level >= sap_first_short_tent;
  const double limit = three_taps ? sap_max_short_variance : 1,
               across = std::clamp(wide, 1 - limit, limit),
               variance = axis == 0 ? across : 1 - across, more = variance - 0.5;
  if (three_taps || more <= 0) return {1 - variance, variance / 2, 0};
  return {0.5 - more / 4, 0.25, more / 8}; // [1 2 1] / 4 filtered with variance `more`
}

std::vector<SapShape> sap_shapes(PixelGrid grid) {
  if (grid == 0) return {{}};
  const uint32_t halvings = std::max(pixel_doublings(grid, 0), pixel_doublings(grid, 1));
  std::vector<SapShape> shapes;
  for (uint32_t k = halvings == 0 ? sap_shape_nodes / 2 : 0; k < sap_shape_nodes; ++k)
    shapes.push_back({.halvings = halvings,
                      .log2_aspect = (double(k) - sap_shape_nodes / 2) * sap_log2_aspect_step});
  return shapes;
}

SapFit fit_sap_weights(SapVariant variant) {
  return fit_sap_weights(variant, burley_shape(1));
}

SapFit fit_sap_weights(SapVariant variant, const ChannelShape& shape, const SapShape& pixel) {
  return fit_sap_weights(std::span(&variant, 1), shape, pixel).front();
}

std::vector<SapFit> fit_sap_weights(std::span<const SapVariant> variants, const ChannelShape& shape,
                                    const SapShape& pixel) {
  const std::vector<Frequency> frequencies = make_frequencies(pixel);
  const std::vector<Folded> folded = fold(frequencies, pixel);
  std::vector<Problem> problems;
  std::vector<SapFit> fits;
  for (const SapVariant variant : variants) {
    problems.push_back(make_problem(frequencies, variant, pixel));
    fits.push_back({.variant = variant, .nodes = {}});
  }
  for (uint32_t k = 0; k < sap_node_count; ++k) {
    const double d_px = std::exp2(sap_log2_d_first + double(k) / sap_nodes_per_octave);
    const std::vector<double> target =
        target_of(frequencies, folded, scaled(shape, d_px / shape.d), pixel);
    for (size_t v = 0; v < fits.size(); ++v) {
      fits[v].nodes[k].d_px = d_px;
      solve_node(problems[v], frequencies, target, shape.direct, fits[v].nodes[k]);
    }
  }
  return fits;
}

SapFractions sap_fractions(const SapWeights& weights) {
  SapFractions fractions{.centre = weights[0], .tent = weights[1], .fraction = {}};
  double rest = 0;
  for (uint32_t level = sap_level_count - 1; level >= 1; --level) {
    rest += weights[level + 1];
    fractions.fraction[level] = rest > 0 ? weights[level + 1] / rest : 1;
  }
  return fractions;
}

std::vector<float> make_sap_table(const SapFit& fit) {
  std::vector<float> table(sap_table_floats);
  for (uint32_t k = 0; k < sap_node_count; ++k) {
    const SapFractions fractions = sap_fractions(fit.nodes[k].weights);
    for (uint32_t row = 0; row < sap_table_rows; ++row) {
      const double value = row == 0   ? fractions.centre
                           : row == 1 ? fractions.tent
                                      : fractions.fraction[row - 1];
      float* pair = &table[size_t{row / 2} * sap_node_count * 4 + row % 2];
      pair[size_t{k} * 4] = static_cast<float>(value);
      if (k > 0) pair[size_t{k - 1} * 4 + 2] = static_cast<float>(value);
      if (k + 1 == sap_node_count) pair[size_t{k} * 4 + 2] = static_cast<float>(value);
    }
  }
  return table;
}

template <class Real> Real sap_lookup(std::span<const float> table, uint32_t row, Real d_px) {
  const float* values = &table[size_t{row / 2} * sap_node_count * 4 + row % 2];
  const Real first = static_cast<Real>(std::exp2(sap_log2_d_first));
  if (!(d_px >= first)) {
    const Real fraction = std::max(Real(0), d_px) / first;
    if (row == 0) return 1 - fraction * (1 - Real(values[0]));
    return row == 1 ? fraction * Real(values[0]) : Real(values[0]);
  }
  const Real at = std::min((std::log2(d_px) - Real(sap_log2_d_first)) * Real(sap_nodes_per_octave),
                           Real(sap_node_count - 1));
  const auto k = std::min(static_cast<uint32_t>(at), sap_node_count - 2);
  const Real t = at - Real(k);
  return (1 - t) * Real(values[size_t{k} * 4]) + t * Real(values[size_t{k} * 4 + 2]);
}
template float sap_lookup<float>(std::span<const float>, uint32_t, float);
template double sap_lookup<double>(std::span<const float>, uint32_t, double);

} // namespace dermis::subsurface
