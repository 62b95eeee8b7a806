#pragma once
// The truth where it is a convolution: orthographic views of planes that face the viewer.

#include "passes/common/reference/reference.hpp"

namespace dermis::subsurface {

// Half the diagonal of a pixel's footprint at the given depth, metres.
double pixel_reach(const PixelRays& rays, double depth);

// K_c integrated over the pixel at integer offset (dx, dy) on a plane facing the viewer: the share of light
// that a pixel receives from there. 0 beyond the truth's radius. Pixel pitches and d in metres; d > 0 in some
// channel. The second form: of any profile, within a radius (reach_of and half a diagonal, or more).
PerChannel planar_weight(double pitch_x, double pitch_y, int64_t dx, int64_t dy, const PerChannel& d);
PerChannel planar_weight(double pitch_x, double pitch_y, int64_t dx, int64_t dy, const ProfileShape& shape,
                         double radius);

// reference_everywhere for an input with is_planar(): normalised convolution a profile and channel, by FFT.
std::vector<double> planar_reference(const ReferenceInput& input, unsigned threads);

} // namespace dermis::subsurface
