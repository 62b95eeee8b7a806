#pragma once
// Passes over reservoirs: a pixel's own sample, its history, its neighbours and its light.
// shaders/restir/reuse.glsl mirrors these functions under the same names. Pure except for scene
// queries; thread: any.

#include "tests/passes/restir/cpu/shift.hpp"

namespace dermis::restir {

// Samples one x2 by a probe and one place on one light, with one shadow ray. The confidence is 1
// even without a sample.
Reservoir draw_initial(const Scene& scene, const Domain& domain, Random& random);

struct ReuseSettings {
  Shift shift = Shift::reconnection; // Shift of this stage.
  Index index = Index::traced;
  double cap = confidence_cap;
};

// Merges both by the generalised balance heuristic (Lin et al. 2022, "Generalized resampled
// importance sampling", eq. 35 with confidences): m_i(y) = c_i p_i(T_i^-1 y) |dT_i^-1/dy| / sum_j.
// `previous_domain` is the pixel of the history. The history's confidence is capped at cap times
// the frame's confidence. If the lights changed, each path is evaluated with the lights of the
// frame in question: removed lights disappear at once and new lights appear at once.
Reservoir merge_temporal(const Scene& scene, const ReuseSettings& settings, const Domain& domain,
                         const Reservoir& current, const Domain& previous_domain,
                         const Reservoir& previous, Random& random);

// Defensive pairwise MIS (Lin et al. 2022, section 7.1.3, with confidences; Bitterli 2022): each
// neighbour is only weighted against the own sample. With the confidences c_c of the own sample and
// C_n of all neighbours, and C = c_c + C_n:
//   m_i(y) = c_i / C * C_n p_i / (C_n p_i + c_c p_c)
//   m_c(y) = c_c / C + sum_i c_i / C * c_c p_c / (C_n p_i + c_c p_c)
struct Spatial {
  Stream stream;
  Reservoir own; // Includes its random numbers if the shift replays.
  double own_target = 0, own_mis = 0;
  double neighbours = 0; // C_n
};
// `neighbours` is the sum of the confidences of all neighbours that will be added; their weights
// depend on it.
Spatial spatial_begin(const Scene& scene, const ReuseSettings& settings, const Domain& domain,
                      const Reservoir& own, double neighbours, Random& random);
void spatial_add(const Scene& scene, const ReuseSettings& settings, const Domain& domain,
                 Spatial& spatial, const Domain& neighbour_domain, const Reservoir& neighbour,
                 Random& random);
Reservoir spatial_end(Spatial& spatial, Random& random);

// Returns the pixel's estimate: scattered diffuse light before albedo.
Vector3 resolve(const Scene& scene, const Domain& domain, const Reservoir& reservoir);

// Returns the search radius for neighbours in pixels: 2 max d over the pixel's footprint (its width
// across the view at x1, in the unit of d), in [5, 30] (supplement, section 5).
double search_radius(const Vector3& d, double footprint);

// Returns the x and y offset from a pixel to a neighbour, uniform over the disc.
std::array<int, 2> neighbour_offset(double radius, Random& random);

} // namespace dermis::restir
