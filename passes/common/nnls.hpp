#pragma once
// Least squares with non-negative unknowns, for few unknowns.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace dermis::subsurface {

template <size_t N> struct NormalEquations {
  std::array<std::array<double, N>, N> matrix{};

  // Adds weight * row * row^T.
  void add_row(const std::array<double, N>& row, double weight) {
    for (size_t i = 0; i < N; ++i) {
      if (row[i] == 0) continue; // unknowns that the fit does not use
      for (size_t j = 0; j < N; ++j)
        matrix[i][j] += weight * row[i] * row[j];
    }
  }
};

// Solves for the unknowns in `used` (Cholesky); others are 0. A pivot that is negligible against
// its diagonal means that the unknown depends on earlier ones: it gets 0.
template <size_t N>
std::array<double, N> solve_some(const NormalEquations<N>& equations,
                                 const std::array<double, N>& right,
                                 const std::array<bool, N>& used) {
  constexpr double singular = 1e-14; // relative to the diagonal: rounding of fp64 sums
  std::array<std::array<double, N>, N> factor{};
  std::array<double, N> x{};
  for (size_t i = 0; i < N; ++i) {
    if (!used[i]) continue;
    double rest = right[i];
    for (size_t j = 0; j < i; ++j) {
      if (factor[j][j] == 0) continue;
      double sum = equations.matrix[i][j];
      for (size_t k = 0; k < j; ++k)
        sum -= factor[i][k] * factor[j][k];
      factor[i][j] = sum / factor[j][j];
      rest -= factor[i][j] * x[j];
    }
    double pivot = equations.matrix[i][i];
    for (size_t k = 0; k < i; ++k)
      pivot -= factor[i][k] * factor[i][k];
    if (pivot <= singular * equations.matrix[i][i]) continue;
    factor[i][i] = std::sqrt(pivot);
    x[i] = rest / factor[i][i];
  }
  for (size_t i = N; i-- > 0;) {
    if (factor[i][i] == 0) continue;
    for (size_t k = i + 1; k < N; ++k)
      x[i] -= factor[k][i] * x[k];
    x[i] /= factor[i][i];
  }
  return x;
}

// Minimises x^T M x - 2 right^T x over x >= 0 by the active-set method of Lawson & Hanson 1974,
// chapter 23.
template <size_t N>
std::array<double, N> solve_non_negative(const NormalEquations<N>& equations,
                                         const std::array<double, N>& right) {
  constexpr double slack = 1e-12; // relative to the largest gradient at 0
  double scale = 0;
  for (const double r : right)
    scale = std::max(scale, std::abs(r));
  std::array<double, N> x{};
  std::array<bool, N> used{};
  for (size_t round = 0; round < 3 * N; ++round) {
    size_t best = N;
    double steepest = slack * scale;
    for (size_t i = 0; i < N; ++i) {
      if (used[i]) continue;
      double gradient = right[i];
      for (size_t j = 0; j < N; ++j)
        gradient -= equations.matrix[i][j] * x[j];
      if (gradient > steepest) {
        steepest = gradient;
        best = i;
      }
    }
    if (best == N) break;
    used[best] = true;
    for (size_t inner = 0; inner <= N; ++inner) {
      const std::array<double, N> solution = solve_some(equations, right, used);
      double step = 1;
      size_t blocking = N;
      for (size_t i = 0; i < N; ++i)
        if (used[i] && solution[i] <= 0) {
          const double reach = x[i] > solution[i] ? x[i] / (x[i] - solution[i]) : 0.0;
          if (reach < step || blocking == N) {
            step = std::min(step, reach);
            blocking = i;
          }
        }
      for (size_t i = 0; i < N; ++i)
        x[i] += step * (solution[i] - x[i]);
      if (blocking == N) break;
      for (size_t i = 0; i < N; ++i)
        if (used[i] && (i == blocking || x[i] <= 0)) {
          used[i] = false;
          x[i] = 0;
        }
    }
  }
  return x;
}

} // namespace dermis::subsurface
