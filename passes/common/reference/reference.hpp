#pragma once
// The reference to which every technique is fitted and compared: scattered light before albedo, in
// fp64.
//
//   L_c(p) = sum_q K_c a_q B_c(q) / sum_q K_c a_q
//
// The sums run over the pixels q with p's profile within shape_reach (20 d for Burley) of the
// widest channel. For a profile with a fraction `direct` of light that never scatters, L = direct B
// + (1 - direct) L_c. B is constant over a pixel, K_c is R_c(|P_q - P_p|) averaged over q's patch
// (pixel_kernel.hpp), and a_q is the patch's area (surface.hpp). A channel with d = 0 returns its B
// unchanged, bit for bit.

#include "passes/common/camera.hpp"
#include "passes/common/reference/pixel_kernel.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace dermis::subsurface {

struct ReferenceInput {
  uint32_t width = 0, height = 0;
  PixelRays rays;
  std::span<const float> light;     // B: 3 per pixel, linear, finite
  std::span<const float> depth;     // view depth, metres
  std::span<const uint8_t> profile; // id per pixel, 0: no subsurface scattering
  // Multiplies d of the receiving pixel p (not of q); >= 0; empty: 1 everywhere.
  std::span<const float> scatter_scale;
  std::span<const PerChannel> d_m; // by profile id: d in metres; an id beyond the end has d = 0
  // By profile id, metres; the size of d_m, with the same d. Empty: all are Burley's.
  std::span<const ProfileShape> shapes{};

  // Returns the shape of an id below d_m.size().
  ProfileShape shape_of(size_t id) const {
    return shapes.empty() ? burley_shapes(d_m[id]) : shapes[id];
  }
};

struct ReferenceOptions {
  unsigned threads = 0;        // 0: one per hardware thread; the result does not depend on it
  bool planar_shortcut = true; // uses fast convolution if the capture allows it exactly
};

// Returns the reference at the listed pixels (index = y * width + x): 3 doubles for each, in that
// order. Pixels without a profile or a valid depth return their light. Spans must have the sizes
// that follow from width and height.
std::vector<double> reference_at(const ReferenceInput& input, std::span<const uint32_t> pixels,
                                 ReferenceOptions options = {});

// Returns the reference at every pixel, 3 doubles per pixel. Captures that are orthographic,
// fronto-parallel for each profile and without scatter_scale are convolved by FFT (seconds at any
// d). Others cost about 20 ns per pair of pixels and thread.
std::vector<double> reference_everywhere(const ReferenceInput& input,
                                         ReferenceOptions options = {});

// Returns whether reference_everywhere can use convolution: an orthographic view with all pixels of
// a profile at one depth.
bool is_planar(const ReferenceInput& input);

// Returns `count` pixels with a profile, one from each of `count` equal parts of the subsurface
// pixels in order of 8x8 tiles; all of them if there are no more than `count`. Deterministic: pcg32
// with the given seed. Sorted by index.
std::vector<uint32_t> stratified_subset(uint32_t width, uint32_t height,
                                        std::span<const uint8_t> profile, uint32_t count,
                                        uint64_t seed = 1);

} // namespace dermis::subsurface
