#include "passes/common/profiles/radial_table.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dermis::subsurface {

std::vector<RadialRow> make_radial_rows(const ProfileShape& shape, int widest) {
  std::vector<RadialRow> rows(radial_rows_per_profile);
  const ChannelShape& leader = shape[static_cast<size_t>(widest)];
  for (uint32_t i = 0; i < radial_nodes; ++i) {
    const double r = leader.d * std::exp2(radial_log2_r_first + i / radial_nodes_per_octave);
    RadialRow &falloff = rows[i], &survival = rows[radial_nodes + i];
    for (size_t c = 0; c < 3; ++c) {
      const double value = shape[c].d > 0 ? 2 * std::numbers::pi * shape_R(shape[c], r) : 0.0;
      falloff[c] = static_cast<float>(value > 0 ? std::max(std::log2(value), radial_min_log2)
                                                : radial_min_log2);
      survival[c] = static_cast<float>(shape_survival(shape[c], r));
    }
    const double root = i / radial_inverse_nodes_per_unit;
    falloff[3] = static_cast<float>(shape_inverse_survival(leader, std::exp2(-root * root)));
    survival[3] = 0;
  }
  return rows;
}

} // namespace dermis::subsurface
