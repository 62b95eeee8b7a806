#include "passes/common/reference/fft.hpp"

#include "passes/common/reference/parallel.hpp"

#include <cmath>
#include <numbers>
#include <utility>

namespace dermis::subsurface {

namespace {

using Complex = std::complex<double>;

// Returns e^(sign 2 pi i k / n) for k < n/2, each from its own angle, so that no error accumulates.
std::vector<Complex> roots_of_unity(size_t n, double sign) {
  std::vector<Complex> roots(n / 2);
  for (size_t k = 0; k < roots.size(); ++k) {
    const double angle = sign * 2 * std::numbers::pi * double(k) / double(n);
    roots[k] = {std::cos(angle), std::sin(angle)};
  }
  return roots;
}

Complex product(Complex a, Complex b) { // without the checks for infinities that operator* makes
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

// Cooley & Tukey 1965, radix 2, decimation in time.
void transform_line(Complex* line, size_t n, const std::vector<Complex>& roots) {
  for (size_t i = 1, j = 0; i < n; ++i) {
    size_t bit = n >> 1;
    for (; j & bit; bit >>= 1)
      j ^= bit;
    j ^= bit;
    if (i < j) std::swap(line[i], line[j]);
  }
  for (size_t half = 1; half < n; half *= 2)
    for (size_t first = 0; first < n; first += 2 * half)
      for (size_t k = 0; k < half; ++k) {
        const Complex a = line[first + k],
                      b = product(line[first + k + half], roots[k * (n / (2 * half))]);
        line[first + k] = a + b;
        line[first + k + half] = a - b;
      }
}

void transform(ComplexImage& image, double sign, unsigned threads) {
  const std::vector<Complex> rows = roots_of_unity(image.width, sign),
                             columns = roots_of_unity(image.height, sign);
  parallel_for(image.height, 16, threads, [&](size_t y) {
    transform_line(&image.values[y * image.width], image.width, rows);
  });
  parallel_for(image.width, 16, threads, [&](size_t x) {
    std::vector<Complex> line(image.height);
    for (size_t y = 0; y < image.height; ++y)
      line[y] = image.values[y * image.width + x];
    transform_line(line.data(), image.height, columns);
    for (size_t y = 0; y < image.height; ++y)
      image.values[y * image.width + x] = line[y];
  });
}

} // namespace

size_t power_of_two_from(size_t n) {
  size_t size = 1;
  while (size < n)
    size *= 2;
  return size;
}

void fft_forward(ComplexImage& image, unsigned threads) {
  transform(image, -1, threads);
}

void fft_inverse(ComplexImage& image, unsigned threads) {
  transform(image, 1, threads);
  const double scale = 1.0 / (double(image.width) * double(image.height));
  for (Complex& value : image.values)
    value *= scale;
}

} // namespace dermis::subsurface
