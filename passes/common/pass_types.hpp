#pragma once
// The pass types of subsurface scattering: signatures alone, no device. Each kind's shader carries the same
// name.

#include "framegraph/model/pass_type.hpp"

namespace dermis::subsurface {

// Every kind a graph may use, in a fixed order. Thread: any.
PassTypeRegistry make_pass_types();

// Below this projected shape parameter d of the widest channel a pixel keeps its own light: 2.6 % of what
// enters at the centre of a pixel leaves its square then (3.6 % the inscribed circle, 1 % the circumscribed
// one), so that errors stay below .026 of the local contrast. The idea is epsilon_u of the 2021 paper,
// sec. 7.
inline constexpr double copy_below_d_px = 0.0546;

// Pixels whose light reaches further than this are not probed: a reference reads the square of it.
inline constexpr int32_t probe_max_reach = 320;

} // namespace dermis::subsurface
