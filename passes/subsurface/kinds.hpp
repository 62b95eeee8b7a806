#pragma once
// The pass kinds of subsurface scattering: signatures alone, no device. Each kind's shader carries the same
// name.

#include "framegraph/model/pass_kind.hpp"

namespace dermis::subsurface {

// Every kind a graph may use, in a fixed order. Thread: any.
KindRegistry make_kinds();

// Below this projected shape parameter d of the widest channel a pixel keeps its own light: less than 1 % of
// the energy leaves it (1 - cdf(r0) < .01; the inscribed circle r0 = .5 px gives d < .0546 px, the equal-area
// circle .061 px; the smaller is taken). Errors stay below .01 of the local contrast (epsilon_u of the 2021
// paper, sec. 7).
inline constexpr double copy_below_d_px = 0.0546;

} // namespace dermis::subsurface
