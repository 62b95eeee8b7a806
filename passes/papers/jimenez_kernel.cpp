#include "passes/papers/jimenez_kernel.hpp"

#include <algorithm>
#include <cmath>

namespace dermis::subsurface {

std::vector<double> jimenez_offsets(uint32_t taps) {
  const double range = taps > 20 ? 3 : 2; // mm
  const size_t side = (taps - 1) / 2;
  std::vector<double> offsets;
  for (size_t i = 1; i <= side; ++i) {
    const double part = static_cast<double>(i) / static_cast<double>(side);
    offsets.push_back(range * part * part);
  }
  return offsets;
}

std::vector<double> jimenez_weights(std::span<const double> offsets, double width,
                                    double strength) {
  // A tap represents half the distance to each of its neighbours; the outermost taps have one
  // neighbour.
  std::vector<double> weights{offsets[0] * artist_R(0, width)};
  double total = weights[0];
  for (size_t i = 0; i < offsets.size(); ++i) {
    const double before = i == 0 ? 0 : offsets[i - 1];
    const double after = i + 1 < offsets.size() ? offsets[i + 1] : offsets[i];
    weights.push_back(0.5 * (after - before) * artist_R(offsets[i], width));
    total += 2 * weights.back();
  }
  for (double& w : weights)
    w *= strength / total;
  weights[0] += 1 - strength;
  return weights;
}

std::vector<SeparableRow> make_jimenez_rows(const ProfileShape& shape) {
  std::vector<SeparableRow> rows(separable_rows_per_profile, SeparableRow{});
  const double widest = std::max({shape[0].d, shape[1].d, shape[2].d});
  const double red = artist_width(1);
  const double d_of_red = artist_shape(red, 1).d; // mm
  size_t first = 0;
  for (const uint32_t taps : separable_taps) {
    const uint32_t per_node = separable_rows_per_node(taps);
    const std::vector<double> offsets = jimenez_offsets(taps);
    std::array<std::vector<double>, 3> weights;
    for (size_t c = 0; c < 3; ++c) {
      const double ratio = widest > 0 ? shape[c].d / widest : 0;
      weights[c] = ratio > 0 ? jimenez_weights(offsets, red * ratio, 1 - shape[c].direct)
                             : std::vector<double>(offsets.size() + 1, 0.0);
      if (!(ratio > 0)) weights[c][0] = 1;
    }
    for (uint32_t node = 0; node < separable_nodes; ++node) {
      const double d_px = std::exp2(separable_first_log2_d + node * separable_log2_d_step);
      SeparableRow* out = &rows[first + size_t{node} * per_node];
      for (size_t i = 0; i <= offsets.size(); ++i) {
        for (size_t c = 0; c < 3; ++c)
          out[i][c] = static_cast<float>(weights[c][i]);
        if (i > 0) out[i][3] = static_cast<float>(offsets[i - 1] * d_px / d_of_red);
      }
      ProfileShape in_pixels;
      for (size_t c = 0; c < 3; ++c)
        in_pixels[c] = scaled(shape[c], widest > 0 ? d_px / widest : 0.0);
      fill_separable_ends(in_pixels, std::span(out, per_node));
    }
    first += size_t{separable_nodes} * per_node;
  }
  return rows;
}

} // namespace dermis::subsurface
