#pragma once
// The pass types of subsurface scattering: only signatures, no device. The shader of each pass type
// has the same name.

#include "framegraph/model/pass_type.hpp"

namespace dermis::subsurface {

// Returns every pass type that a graph may use, in a fixed order. Thread: any.
PassTypeRegistry make_pass_types();

// A pixel with a smaller projected shape parameter d of the widest channel keeps its own light. At
// this d, 2.6 % of the light that enters at the centre of a pixel leaves its square (3.6 % leave
// the inscribed circle, 1 % the circumscribed circle), so that errors stay below 0.026 of the local
// contrast. The idea is epsilon_u of Xie, Xu & Boksansky 2021, sec. 7.
inline constexpr double copy_below_d_px = 0.0546;

} // namespace dermis::subsurface
