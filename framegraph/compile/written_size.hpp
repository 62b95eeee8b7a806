#pragma once

#include "framegraph/compile/plan.hpp"
#include "framegraph/model/pass_type.hpp"

namespace dermis {

struct TexelSize {
  uint32_t width = 0, height = 0;
};

// Returns the size of the first subresource, in the order of the ports, of an image that the pass
// writes from a shader; zero if it writes none. DispatchRule::Domain::written_image covers it.
TexelSize first_written_size(const Plan& plan, const PlanPass& pass, const PassType& type);

} // namespace dermis
