// Burley's profile at many radii at once, in vector instructions.

#include "passes/common/profiles/burley_profile.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <numbers>

// Compiles the function a second time for processors with 256-bit vectors, if the loader can choose
// between the versions. Both give the same bits.
#if defined(__x86_64__) && defined(__ELF__) && defined(__GNUC__) && !defined(__clang__) &&         \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define DERMIS_WIDE_VECTORS __attribute__((target_clones("avx2", "default")))
#else
#define DERMIS_WIDE_VECTORS
#endif

namespace dermis::subsurface {

namespace {

// Returns e^x for x in [-700, 0] without branches or tables, so that a loop over the function is
// vectorised. x = n ln 2 + f with |f| <= ln 2 / 2; Taylor's series of e^f to its 12th term (the
// next is below 2e-16); n is added to the exponent's bits.
inline double exp_of_negative(double x) {
  // adding this moves the integer part of a number to its lowest bits
  constexpr double to_integer = 0x1.8p52;
  constexpr double factorials[] = {39916800, 3628800, 362880, 40320, 5040, 720,
                                   120,      24,      6,      2,     1,    1};
  const double shifted = x * std::numbers::log2e + to_integer;
  const double n = shifted - to_integer;
  // ln 2 in two parts: the product of n and the first part is exact.
  const double f = (x - n * 0x1.62e42fefap-1) - n * 0x1.cf79abc9e3b39p-40;
  double sum = 1.0 / 479001600;
  for (const double factorial : factorials)
    sum = sum * f + 1 / factorial;
  return std::bit_cast<double>(std::bit_cast<int64_t>(sum) +
                               (std::bit_cast<int64_t>(shifted) << 52));
}

// Returns the smaller of two positive numbers, compared by their bits, because comparisons of
// floating-point numbers may trap and prevent vectorisation.
inline double smaller(double a, double b) {
  return std::bit_cast<double>(std::min(std::bit_cast<int64_t>(a), std::bit_cast<int64_t>(b)));
}

} // namespace

DERMIS_WIDE_VECTORS void burley_R(std::span<const double> r, double d, std::span<double> result) {
  if (!(d > 0)) {
    std::fill(result.begin(), result.end(), 0.0);
    return;
  }
  const double per_radius = -1 / (3 * d), total = 1 / (8 * std::numbers::pi * d),
               last = burley_negligible_in_d * d;
  const double* from = r.data();
  double* to = result.data();
  for (size_t i = 0; i < r.size(); ++i) {
    const double radius = smaller(from[i], last), t = exp_of_negative(radius * per_radius);
    to[i] = t * (1 + t * t) * total / radius;
  }
}

} // namespace dermis::subsurface
