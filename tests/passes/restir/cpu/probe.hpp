#pragma once
// BSSRDF importance sampling by probe rays (King et al. 2013; Christensen & Burley 2015; subsurface.md R6,
// R11): a point is drawn on a disc around x1, across one of three axes and for one of three channels, and a
// segment through it finds surfaces. shaders/restir/probe.glsl mirrors these functions under the same
// names. Pure; thread: any.

#include "tests/passes/restir/cpu/domain.hpp"

#include <array>

namespace dermis::restir {

using Barycentrics = std::array<double, 2>; // of the second and third vertex

inline constexpr std::array<double, 3> probe_axis_fraction = {0.5, 0.25, 0.25}; // normal, tangents (R11)
inline constexpr uint32_t max_probe_hits = 16; // surfaces along one probe; more are not seen
// A count of hits that was not traced: taken for that of whatever it is compared with (Index::drawn).
inline constexpr uint32_t assumed_hits = 255;

// The random numbers of one point x2, with the choices they lead to.
struct ProbeNumbers {
  uint32_t axis = 0, channel = 0;
  double survival = 1; // 1 - probe_fraction u: the share of a channel's energy beyond the disc's radius
  double angle = 0;    // of a full turn, [0, 1)
  double pick = 0;     // which of the hits, [0, 1)
};

struct ProbeRay {
  Vector3 origin{}, direction{}; // unit length
  double length = 0;
};

struct ProbeHit {
  uint32_t instance = 0, primitive = 0;
  Barycentrics barycentrics{};
  double distance = 0;
};

struct ProbeHits {
  uint32_t count = 0;
  std::array<ProbeHit, max_probe_hits> hit{};
};

// From four uniform numbers: axis and channel (uniform among those with d > 0), radius, angle, pick.
ProbeNumbers draw_numbers(const Vector3& d, const std::array<double, 4>& u);
// The chord of the ball of the channel's reach through the point on the disc.
ProbeRay probe_of(const Domain& domain, const ProbeNumbers& numbers);
// Which of `count` > 0 hits.
uint32_t picked_hit(double pick, uint32_t count);

// Density per area of x2 by one axis and channel, their probability included, the choice among hits not.
double probe_technique_pdf(const Domain& domain, uint32_t axis, uint32_t channel, const Vector3& position,
                           const Vector3& normal);
// Over all of them: what is divided by, times one over the number of hits of the probe that was traced (the
// balance heuristic over axes and channels: each weight is alpha_t p_t / sum, without the other probes'
// hits).
double probe_pdf(const Domain& domain, const Vector3& position, const Vector3& normal);

// Probabilistic inversion (eq. 13 to 15 of the supplement): axis and channel drawn by how likely each has led
// to x2 (`u`), radius and angle re-found; `pick` is left at 0. False where none can lead there.
bool invert_point(const Domain& domain, const Vector3& position, const Vector3& normal, double u,
                  ProbeNumbers& numbers);
// The number that picks the hit on this primitive, `u` uniform in [0, 1): (index + u) / count. False where
// the probe does not meet it.
bool invert_pick(const ProbeHits& hits, uint32_t instance, uint32_t primitive, double u, double& pick);

} // namespace dermis::restir
