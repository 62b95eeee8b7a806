#include "passes/separable/separable_kernel.hpp"

#include "passes/common/nnls.hpp"
#include "passes/common/sinc.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dermis::subsurface {

namespace {

using std::numbers::pi;
constexpr size_t unknowns = separable_max_side + 2; // taps at 0 and at each side, then the delta

// Frequencies of the fit: log-spaced radii from wavelengths of some hundred d to the pixel grid's
// corner, over the first quadrant. A pair (fx, fy) represents its area of the log-polar grid.
constexpr double separable_min_frequency = 1.0 / 2048;
constexpr double separable_max_frequency = 0.70710678;
constexpr int radii = 30;
constexpr int angles = 5;
// Power spectrum of natural images: amplitude 1/f, power f^-2 per unit area (Field 1987). On a
// log-polar grid the area grows as f^2, which gives equal weights.

struct FitFrequency {
  double x, y, weight, target = 0; // target: transfer of the reference's kernel
};

// Terms of the transfer of the pixel's kernel at a frequency and its aliases; independent of the
// shape.
struct Aliases {
  static constexpr int maximum = 8; // periods on each side
  static constexpr size_t count = 2 * maximum + 1;
  std::array<double, count> sinc_x, sinc_y;
  std::array<std::array<double, count>, count> k; // by y, x: radians per pixel
};

Aliases aliases_of(double fx, double fy) {
  Aliases aliases;
  for (int m = -Aliases::maximum; m <= Aliases::maximum; ++m) {
    const auto at = static_cast<size_t>(m + Aliases::maximum);
    aliases.sinc_x[at] = sinc(fx + m);
    aliases.sinc_y[at] = sinc(fy + m);
    for (int n = -Aliases::maximum; n <= Aliases::maximum; ++n)
      aliases.k[at][static_cast<size_t>(n + Aliases::maximum)] =
          2 * pi * std::hypot(fx + n, fy + m);
  }
  return aliases;
}

double transfer_of(const ChannelShape& shape, const Aliases& aliases) {
  // Aliases fall as |f|^-1 (profile) times 1/f^2 (box); their sum converges to 1e-4 within 8
  // periods for d >= 1/16 px.
  const int reach = shape.d > 0 ? std::clamp(static_cast<int>(2 + 2 / shape.d), 2, Aliases::maximum)
                                : Aliases::maximum;
  const auto first = static_cast<size_t>(Aliases::maximum - reach),
             last = static_cast<size_t>(Aliases::maximum + reach);
  double sum = 0;
  for (size_t y = first; y <= last; ++y)
    for (size_t x = first; x <= last; ++x)
      sum += shape_transfer(shape, aliases.k[y][x]) * aliases.sinc_x[x] * aliases.sinc_y[y];
  return shape.direct + (1 - shape.direct) * sum;
}

// The frequencies of every fit, and their aliases.
struct Grid {
  std::vector<FitFrequency> frequencies;
  std::vector<Aliases> aliases;
};

Grid make_grid() {
  Grid grid;
  for (int i = 0; i < radii; ++i) {
    const double f = separable_min_frequency *
                     std::pow(separable_max_frequency / separable_min_frequency, (i + 0.5) / radii);
    for (int j = 0; j < angles; ++j) {
      const double angle = (j + 0.5) / angles * pi / 2;
      const double fx = f * std::cos(angle), fy = f * std::sin(angle);
      if (fx > 0.5 || fy > 0.5) continue;
      grid.frequencies.push_back({fx, fy, 1.0});
      grid.aliases.push_back(aliases_of(fx, fy));
    }
  }
  return grid;
}

std::vector<FitFrequency> with_targets(const Grid& grid, const ChannelShape& shape) {
  std::vector<FitFrequency> all = grid.frequencies;
  for (size_t i = 0; i < all.size(); ++i)
    all[i].target = transfer_of(shape, grid.aliases[i]);
  return all;
}

// Returns the transfer of the two taps at +-offset, read with linear interpolation between texels.
double tap_transfer(double offset, double f) {
  const double below = std::floor(offset), part = offset - below;
  return 2 *
         ((1 - part) * std::cos(2 * pi * f * below) + part * std::cos(2 * pi * f * (below + 1)));
}

// Per axis: the transfer of every unknown of `a` at a frequency.
using Row = std::array<double, separable_max_side + 1>;

Row axis_row(std::span<const double> offsets, double f) {
  Row row{1.0};
  for (size_t i = 0; i < offsets.size(); ++i)
    row[i + 1] = tap_transfer(offsets[i], f);
  return row;
}

double dot(const Row& row, const Row& weights) {
  double sum = 0;
  for (size_t i = 0; i < row.size(); ++i)
    sum += row[i] * weights[i];
  return sum;
}

// By frequency, both axes; independent of the shape.
struct Sample {
  Row x, y;
};

std::vector<Sample> make_samples(const std::vector<FitFrequency>& frequencies,
                                 std::span<const double> offsets) {
  std::vector<Sample> samples;
  for (const FitFrequency& f : frequencies)
    samples.push_back({axis_row(offsets, f.x), axis_row(offsets, f.y)});
  return samples;
}

SeparableFit fit_to(const std::vector<FitFrequency>& frequencies,
                    const std::vector<Sample>& samples, double d_px,
                    std::span<const double> offsets) {
  SeparableFit fit;
  const size_t taps = offsets.size() + 1;

  // Unknowns: an unnormalised `a` (its square includes 1 - centre) and the centre. Gauss-Newton on
  // the product, with a non-negative least-squares problem per step; the sum of the kernel, 1, is a
  // row of large weight.
  constexpr int steps = 12;
  constexpr double sum_weight = 1e6;
  Row a{};
  // Starts from the outer exponential of the radial marginal.
  for (size_t i = 0; i < taps; ++i)
    a[i] = std::exp(-(i == 0 ? 0.0 : offsets[i - 1]) / (2 * d_px)) + 1e-3;
  double sum = a[0];
  for (size_t i = 1; i < taps; ++i)
    sum += 2 * a[i];
  for (double& x : a)
    x /= sum;
  double centre = 0.2;
  for (double& x : a)
    x *= std::sqrt(1 - centre);
  const Row ones = axis_row(offsets, 0.0);
  for (int step = 0; step < steps; ++step) {
    NormalEquations<unknowns> equations;
    std::array<double, unknowns> right{};
    auto add = [&](const Row& x, const Row& y, double target, double weight) {
      const double ax = dot(x, a), ay = dot(y, a);
      std::array<double, unknowns> row{};
      for (size_t i = 0; i < taps; ++i)
        row[i] = x[i] * ay + y[i] * ax;
      row[unknowns - 1] = 1;
      equations.add_row(row, weight);
      const double value = target + ax * ay; // linearised about a: row * a = 2 ax ay
      for (size_t i = 0; i < unknowns; ++i)
        right[i] += weight * row[i] * value;
    };
    for (size_t i = 0; i < samples.size(); ++i)
      add(samples[i].x, samples[i].y, frequencies[i].target, frequencies[i].weight);
    add(ones, ones, 1.0, sum_weight);
    const auto solved = solve_non_negative(equations, right);
    constexpr double damping = 0.7; // a full step overshoots while the active set still changes
    for (size_t i = 0; i < taps; ++i)
      a[i] += damping * (solved[i] - a[i]);
    centre += damping * (solved[unknowns - 1] - centre);
  }
  sum = dot(ones, a);
  fit.weights = {};
  for (size_t i = 0; i < taps; ++i)
    fit.weights[i] = a[i] / sum;
  fit.centre = std::clamp(1 - sum * sum, 0.0, 1.0);

  double error = 0, signal = 0;
  for (size_t i = 0; i < samples.size(); ++i) {
    const FitFrequency& f = frequencies[i];
    const double model = fit.centre + (1 - fit.centre) * dot(samples[i].x, fit.weights) *
                                          dot(samples[i].y, fit.weights);
    error += f.weight * (model - f.target) * (model - f.target);
    signal += f.weight * (1 - f.target) * (1 - f.target);
  }
  fit.residual = signal > 0 ? std::sqrt(error / signal) : 0;
  return fit;
}

// Returns the offset of the last tap divided by d. Reach and spacing have the smallest fit error
// over d = 1 .. 32 px, found by scanning (docs/techniques.md).
double reach_of_d(uint32_t taps) {
  return taps >= 25 ? 10 : taps >= 17 ? 7 : 5;
}

} // namespace

double pixel_kernel_transfer(double d_px, double fx, double fy) {
  return pixel_kernel_transfer(burley_shape(d_px), fx, fy);
}

double pixel_kernel_transfer(const ChannelShape& shape, double fx, double fy) {
  return transfer_of(shape, aliases_of(fx, fy));
}

std::vector<double> separable_offsets(double d_px, uint32_t taps) {
  const size_t side = (taps - 1) / 2;
  const double reach = reach_of_d(taps) * d_px;
  const double power = taps >= 25 ? 3.5 : taps >= 17 ? 2.5 : 2.0;
  std::vector<double> offsets(side);
  double last = 0;
  for (size_t i = 0; i < side; ++i) {
    const double part = static_cast<double>(i + 1) / static_cast<double>(side);
    const double offset = reach * std::pow(part, power);
    last = std::max(last + 1, taps >= separable_whole_taps ? std::round(offset) : offset);
    offsets[i] = last;
  }
  return offsets;
}

int32_t separable_reach_px(double d_px, uint32_t taps) {
  constexpr double longer = 1.05; // interpolation between nodes, and another pixel's kernel
  constexpr int32_t more = 3;
  const double reach = std::max((taps - 1) / 2.0, longer * reach_of_d(taps) * d_px);
  return static_cast<int32_t>(std::min(std::ceil(reach), 32768.0)) + more;
}

SeparableFit fit_separable(double d_px, std::span<const double> offsets) {
  return fit_separable(burley_shape(d_px), offsets);
}

SeparableFit fit_separable(const ChannelShape& shape, std::span<const double> offsets) {
  if (!(shape.d > 0)) return {};
  const Grid grid = make_grid();
  return fit_to(with_targets(grid, shape), make_samples(grid.frequencies, offsets), shape.d,
                offsets);
}

std::vector<SeparableRow> make_separable_rows(const std::array<double, 3>& d) {
  return make_separable_rows(
      ProfileShape{burley_shape(d[0]), burley_shape(d[1]), burley_shape(d[2])});
}

std::vector<SeparableRow> make_separable_rows(const ProfileShape& shape) {
  std::vector<SeparableRow> rows(separable_rows_per_profile, SeparableRow{});
  const double widest = std::max({shape[0].d, shape[1].d, shape[2].d});
  const Grid grid = make_grid();
  for (uint32_t node = 0; node < separable_nodes; ++node) {
    const double d_px = std::exp2(separable_first_log2_d + node * separable_log2_d_step);
    std::array<ChannelShape, 3> channels;
    std::array<std::vector<FitFrequency>, 3> frequencies;
    for (size_t c = 0; c < 3; ++c) {
      channels[c] = scaled(shape[c], widest > 0 ? d_px / widest : 0.0);
      if (channels[c].d > 0) frequencies[c] = with_targets(grid, channels[c]);
    }
    size_t first = 0;
    for (const uint32_t taps : separable_taps) {
      const uint32_t per_node = separable_rows_per_node(taps);
      SeparableRow* out = &rows[first + size_t{node} * per_node];
      const std::vector<double> offsets = separable_offsets(d_px, taps);
      const std::vector<Sample> samples = make_samples(grid.frequencies, offsets);
      for (size_t c = 0; c < 3; ++c) {
        const SeparableFit fit = channels[c].d > 0
                                     ? fit_to(frequencies[c], samples, channels[c].d, offsets)
                                     : SeparableFit{};
        for (size_t i = 0; i <= offsets.size(); ++i)
          out[i][c] = static_cast<float>(fit.weights[i]);
        out[separable_centre_row(taps)][c] = static_cast<float>(fit.centre);
      }
      for (size_t i = 0; i < offsets.size(); ++i)
        out[i + 1][3] = static_cast<float>(offsets[i]);
      fill_separable_ends(channels, std::span(out, per_node));
      first += size_t{separable_nodes} * per_node;
    }
  }
  return rows;
}

double make_separable_decay(const ProfileShape& shape, double offset) {
  constexpr std::array luminance = {0.2126, 0.7152, 0.0722}; // Rec. 709
  double sum = 0, weight = 0;
  for (size_t c = 0; c < 3; ++c) {
    const double d = shape[c].d;
    if (!(d > 0)) continue;
    // Beyond a few hundred d, where shape_R is 0, the decay stays as it is there.
    const double near = std::clamp(offset, 1e-3 * d, 100 * d);
    const double far = near + std::max((std::numbers::sqrt2 - 1) * near, d);
    double ratio = shape_R(shape[c], near) / shape_R(shape[c], far);
    if (shape[c].model == ProfileModel::burley) ratio *= near / far;
    sum += luminance[c] * std::log2(std::max(ratio, 1.0)) / (far - near);
    weight += luminance[c];
  }
  // Above 0, so that an infinite rise gives a weight of 0.
  return weight > 0 ? std::max(sum / weight, 1e-6) : 1.0;
}

void fill_separable_ends(const ProfileShape& shape, std::span<SeparableRow> node) {
  const auto chosen = std::ranges::find_if(
      separable_taps, [&](uint32_t taps) { return separable_rows_per_node(taps) == node.size(); });
  const uint32_t taps = *chosen, side = (taps - 1) / 2;
  SeparableEnds ends;
  while (ends.dense < side && node[ends.dense + 1][3] == float(ends.dense + 1))
    ++ends.dense;
  std::array<double, 3> tail{};
  for (uint32_t i = side; i > 0 && ends.used == 0; --i)
    for (size_t c = 0; c < 3; ++c) {
      tail[c] += 2 * double{node[i][c]};
      if (tail[c] >= separable_min_tail) ends.used = i;
    }
  const bool burley = std::ranges::all_of(
      shape, [](const ChannelShape& one) { return one.model == ProfileModel::burley; });
  ends.core = burley ? 0 : separable_flat_core;
  node[separable_ends_row(taps)] = {float(ends.dense), float(ends.used), float(ends.core), 0};
  for (uint32_t i = 0; i < side; ++i)
    node[separable_decay_row(taps) + i / 4][i % 4] =
        static_cast<float>(make_separable_decay(shape, double{node[i + 1][3]}));
}

SeparableRow separable_row(std::span<const SeparableRow> rows, uint32_t choice, double d_px,
                           uint32_t row) {
  size_t first = 0;
  for (uint32_t i = 0; i < choice; ++i)
    first += size_t{separable_nodes} * separable_rows_per_node(separable_taps[i]);
  const double last_node = separable_nodes - 1;
  const double position = (std::log2(d_px) - separable_first_log2_d) / separable_log2_d_step;
  const double clamped = std::clamp(position, 0.0, last_node);
  const auto node = static_cast<size_t>(std::min(std::floor(clamped), last_node - 1));
  const double part = clamped - static_cast<double>(node);
  const uint32_t per_node = separable_rows_per_node(separable_taps[choice]);
  const SeparableRow& low = rows[first + node * per_node + row];
  const SeparableRow& high = rows[first + (node + 1) * per_node + row];
  SeparableRow result;
  for (size_t i = 0; i < 4; ++i)
    result[i] = static_cast<float>(low[i] + part * (high[i] - low[i]));
  // Beyond the last node the kernel keeps its shape: offsets grow with d.
  result[3] *=
      static_cast<float>(std::exp2(std::max(0.0, position - last_node) * separable_log2_d_step));
  return result;
}

} // namespace dermis::subsurface
