#pragma once
// Radius beyond which a given fraction of a profile's energy lies, for profiles without a closed
// inverse.

#include <cmath>

namespace dermis::subsurface {

// Solves survival(r) = u for r >= 0. `survival` falls from 1 to 0 and its derivative is -density.
// `guess` is any positive length of the profile. Uses Newton's steps on log survival, which is
// almost linear in the tail; a step out of the bracket becomes a bisection. Relative error below
// 1e-12.
template <class Survival, class Density>
double invert_survival(double u, double guess, Survival survival, Density density) {
  constexpr int doublings = 200, steps = 200;
  constexpr double precise = 1e-13;
  if (!(u < 1)) return 0;
  double low = 0, high = guess;
  for (int i = 0; i < doublings && survival(high) > u; ++i) {
    low = high;
    high *= 2;
  }
  const double target = std::log(u);
  double r = 0.5 * (low + high);
  for (int i = 0; i < steps && high - low > precise * high; ++i) {
    const double fraction = survival(r);
    (fraction > u ? low : high) = r;
    const double next = r + (std::log(fraction) - target) * fraction / density(r);
    const double before = r;
    r = next > low && next < high ? next : 0.5 * (low + high);
    if (std::abs(r - before) <= precise * r) break;
  }
  return r;
}

} // namespace dermis::subsurface
