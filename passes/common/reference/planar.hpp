#pragma once
// The reference as a convolution, for orthographic views of planes that face the viewer.

#include "passes/common/reference/reference.hpp"

namespace dermis::subsurface {

// Returns half the diagonal of a pixel's footprint at the given depth, metres.
double half_pixel_diagonal(const PixelRays& rays, double depth);

// Returns the fraction of its light that a pixel receives from the pixel at integer offset (dx, dy)
// on a plane facing the viewer: R_c integrated over that pixel. 0 beyond the reference's radius.
// Pixel pitches and d are in metres; d > 0 in at least one channel. The second overload takes any
// profile and a cut-off radius (at least reach_of plus half a diagonal).
PerChannel planar_weight(double pitch_x, double pitch_y, int64_t dx, int64_t dy,
                         const PerChannel& d);
PerChannel planar_weight(double pitch_x, double pitch_y, int64_t dx, int64_t dy,
                         const ProfileShape& shape, double radius);

// reference_everywhere for an input with is_planar(): normalised convolution per profile and
// channel, by FFT.
std::vector<double> planar_reference(const ReferenceInput& input, unsigned threads);

} // namespace dermis::subsurface
