#pragma once
// Counts the bytes that the passes of a plan read and write, from the plan's accesses.

#include "framegraph/compile/plan.hpp"

#include <vector>

namespace dermis {

// Properties of a picture that a plan does not contain, as fractions.
struct TrafficAssumptions {
  double covered = 0.5; // of the view's pixels: pixels to which the effect applies
  double flagged = 0.5; // of the texels of a port with AccessExtent::flagged
  // The same in images of at least a quarter of the view's texels, where fewer are next to edges.
  double flagged_fine = 0.1;
};

struct PassTraffic { // bytes per covered pixel of the view
  double read = 0.0, written = 0.0;
};

// Returns the traffic of each pass, in plan order. Each texel and each element counts once per pass
// and port: caches serve neighbours and repeated reads.
// - Image: bytes per texel, times the texels of the port's mips and layers.
// - Buffer: its bytes, times the texels of the largest image that the pass writes per pixel of the
//   view (a coarse level reads only its part of a list). If the port declares bytes per tile, these
//   times the tiles of that image.
// - A dispatch over a list accesses the covered fraction, as do ports with AccessExtent::covered.
// - An updated resource counts as read and as written.
// Not counted: indirect arguments, acceleration structures, constants, tables, counters, passes of
// the host, and the fallback of an invalid history.
std::vector<PassTraffic> count_traffic(const Plan& plan, const PassTypeRegistry& pass_types,
                                       const TrafficAssumptions& assumptions = {});

} // namespace dermis
