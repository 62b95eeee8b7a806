#pragma once
// Radii of the mean of several Burley distributions: one stratified variable for channels with
// different d. Mirrors shaders/afis/mixture.glsl in fp64. Thread: any.

#include "passes/common/reference/pixel_kernel.hpp"

namespace dermis::subsurface {

// Returns the mean over the channels with d > 0 of the fraction beyond r. All lengths have one
// unit.
double burley_mixture_survival(double r, const PerChannel& d);
// Returns the density at r per unit of length.
double burley_mixture_pdf(double r, const PerChannel& d);
// Returns the radius at survival u in (0, 1]; at least one d > 0. Runs eight steps of Newton's
// method on the logarithm of the survival.
double burley_mixture_inverse(double u, const PerChannel& d);

} // namespace dermis::subsurface
