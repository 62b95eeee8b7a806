#include "tests/passes/common/cpu/burley_mixture.hpp"

#include "passes/common/profiles/burley_profile.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::subsurface {

namespace {

constexpr int mixture_steps = 8;

template <class Value> double mean_of_scattering(const PerChannel& d, Value value) {
  double sum = 0, count = 0;
  for (const double one : d)
    if (one > 0) {
      sum += value(one);
      ++count;
    }
  return count > 0 ? sum / count : 0;
}

} // namespace

double burley_mixture_survival(double r, const PerChannel& d) {
  return mean_of_scattering(
      d, [&](double one) { return 0.25 * std::exp(-r / one) + 0.75 * std::exp(-r / (3 * one)); });
}

double burley_mixture_pdf(double r, const PerChannel& d) {
  return mean_of_scattering(d, [&](double one) { return burley_pdf(r, one); });
}

double burley_mixture_inverse(double u, const PerChannel& d) {
  double narrowest = 0, widest = 0;
  for (const double one : d)
    if (one > 0) {
      narrowest = narrowest > 0 ? std::min(narrowest, one) : one;
      widest = std::max(widest, one);
    }
  double r = std::max(burley_inverse_survival(u, narrowest), 1e-6 * narrowest);
  for (int i = 0; i < mixture_steps; ++i) {
    const double survival = burley_mixture_survival(r, d);
    r = std::clamp(r + survival * std::log(survival / u) / burley_mixture_pdf(r, d),
                   1e-6 * narrowest, 50 * widest);
  }
  return r;
}

} // namespace dermis::subsurface
