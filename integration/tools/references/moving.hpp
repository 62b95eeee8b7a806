#pragma once
// Exponentially weighted moving means, variances and covariances in fp64: CPU references of the
// half-float values in guidance kernels. All start with the first observation and spread 0.

namespace dermis::subsurface {

// Equations 5 and 6 of the 2021 paper (A1, A2 of docs/papers.md). For independent values the result
// is 2 (1 - eta) / (2 - eta) times their variance.
struct MovingVariance {
  double mean = 0, variance = 0;
  bool begun = false;

  void add(double x, double eta) {
    if (!begun) mean = x;
    begun = true;
    const double step = x - mean;
    mean += eta * step;
    variance = (1 - eta) * (variance + eta * step * step);
  }
};

// Equation 32 of the paper, 21 of its supplement (EMC; C5). Equals the explicitly weighted
// covariance about the updated means, with weights (1 - eta)^n for the first of n + 1 values and
// eta (1 - eta)^(n - i) for the others.
struct MovingCovariance {
  double mean_f = 0, mean_g = 0, covariance = 0, variance_g = 0;
  bool begun = false;

  void add(double f, double g, double eta) {
    if (!begun) {
      mean_f = f;
      mean_g = g;
    }
    begun = true;
    const double step_f = f - mean_f, step_g = g - mean_g;
    mean_f += eta * step_f;
    mean_g += eta * step_g;
    covariance = (1 - eta) * (covariance + eta * step_f * step_g);
    variance_g = (1 - eta) * (variance_g + eta * step_g * step_g);
  }
};

// Equations 34 to 36 (EWMA; C6). Uses a factor eta instead of eta (1 - eta), so the result is
// always 1 / (1 - eta) times that of EMC.
struct WeightedCovariance {
  double mean_f = 0, mean_g = 0, covariance = 0;
  bool begun = false;

  void add(double f, double g, double eta) {
    if (!begun) {
      mean_f = f;
      mean_g = g;
    }
    begun = true;
    const double step_f = f - mean_f, step_g = g - mean_g;
    mean_f += eta * step_f;
    mean_g += eta * step_g;
    covariance = (1 - eta) * covariance + eta * step_f * step_g;
  }
};

} // namespace dermis::subsurface
