#pragma once
// Convolution of images by the discrete Fourier transform, fp64.

#include <complex>
#include <cstddef>
#include <vector>

namespace dermis::subsurface {

// A complex image whose sides are powers of two, row-major.
struct ComplexImage {
  size_t width = 0, height = 0;
  std::vector<std::complex<double>> values;
};

// Returns the smallest power of two that is not below n (n >= 1).
size_t power_of_two_from(size_t n);

// Transform in place, unnormalised; the inverse divides by width * height. Relative error about
// 1e-15 * log2(size).
void fft_forward(ComplexImage& image, unsigned threads);
void fft_inverse(ComplexImage& image, unsigned threads);

} // namespace dermis::subsurface
