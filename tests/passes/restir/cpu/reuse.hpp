#pragma once
// Passes over reservoirs: a pixel's own sample, its history, its neighbours, its light.
// shaders/restir/reuse.glsl mirrors these functions under the same names. Pure but for what the scene
// is asked; thread: any.

#include "tests/passes/restir/cpu/shift.hpp"

namespace dermis::restir {

// One x2 by a probe, one place on one light, one shadow ray; confidence 1, without a sample too.
Reservoir draw_initial(const Scene& scene, const Domain& domain, Random& random);

struct ReuseSettings {
  Shift shift = Shift::reconnection; // of this stage
  Index index = Index::traced;
  double cap = confidence_cap;
};

// Generalised balance heuristic over both (Lin et al. 2022, "Generalized resampled importance sampling", eq.
// 35 with confidences): m_i(y) = c_i p_i(T_i^-1 y) |dT_i^-1/dy| / sum_j. `previous_domain` is the pixel of
// the history. The history's confidence is capped at cap times the frame's. Where the scene had other lights
// before, each path is lit by those of the frame it is looked at in: no light that went out lives on, none
// that came is held back.
Reservoir merge_temporal(const Scene& scene, const ReuseSettings& settings, const Domain& domain,
                         const Reservoir& current, const Domain& previous_domain, const Reservoir& previous,
                         Random& random);

// Defensive pairwise MIS (Lin et al. 2022, section 7.1.3, with confidences; Bitterli 2022): each neighbour
// against the own sample alone. With c_c and C_n the confidences of own and of all neighbours, C = c_c + C_n:
//   m_i(y) = c_i / C * C_n p_i / (C_n p_i + c_c p_c)
//   m_c(y) = c_c / C + sum_i c_i / C * c_c p_c / (C_n p_i + c_c p_c)
struct Spatial {
  Stream stream;
  Reservoir own; // with its random numbers, where the shift replays
  double own_target = 0, own_mis = 0;
  double neighbours = 0; // C_n
};
// `neighbours`: the sum of the confidences of all neighbours that will be added; it decides their weights.
Spatial spatial_begin(const Scene& scene, const ReuseSettings& settings, const Domain& domain,
                      const Reservoir& own, double neighbours, Random& random);
void spatial_add(const Scene& scene, const ReuseSettings& settings, const Domain& domain, Spatial& spatial,
                 const Domain& neighbour_domain, const Reservoir& neighbour, Random& random);
Reservoir spatial_end(Spatial& spatial, Random& random);

// The pixel's estimate: scattered diffuse light before albedo.
Vector3 resolve(const Scene& scene, const Domain& domain, const Reservoir& reservoir);

// How far neighbours are looked for, pixels: 2 max d as the pixel's footprint (its width across the view at
// x1, in d's unit) shows it, in [5, 30] (supplement, section 5).
double search_radius(const Vector3& d, double footprint);

// From a pixel to a neighbour, x and y, uniform over the disc.
std::array<int, 2> neighbour_offset(double radius, Random& random);

} // namespace dermis::restir
