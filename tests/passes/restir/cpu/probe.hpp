#pragma once
// BSSRDF importance sampling by probe rays (King et al. 2013; Christensen & Burley 2015;
// subsurface.md R6, R11). A point is sampled on a disc around x1, perpendicular to one of three
// axes, with the radius of one of three channels; a segment through the point finds surfaces.
// shaders/restir/probe.glsl mirrors these functions under the same names. Pure; thread: any.

#include "tests/passes/restir/cpu/domain.hpp"

#include <array>

namespace dermis::restir {

using Barycentrics = std::array<double, 2>; // Weights of the second and third vertex.

// Normal, tangents.
inline constexpr std::array<double, 3> probe_axis_fraction = {0.5, 0.25, 0.25};
// Maximum number of surfaces along one probe; more are ignored.
inline constexpr uint32_t max_probe_hits = 16;
// A hit count that was not traced: treated as equal to any count it is compared with
// (Index::sampled).
inline constexpr uint32_t assumed_hits = 255;

// The random numbers of one point x2, and the choices that follow from them.
struct ProbeNumbers {
  uint32_t axis = 0, channel = 0;
  // 1 - probe_fraction u: the fraction of a channel's energy beyond the disc's radius.
  double survival = 1;
  double angle = 0; // Fraction of a full turn, [0, 1).
  double pick = 0;  // Selects one of the hits, [0, 1).
};

struct ProbeRay {
  Vector3 origin{}, direction{}; // `direction` has unit length.
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

// Returns the choices of four uniform numbers: axis and channel (uniform among channels with d >
// 0), radius, angle, pick.
ProbeNumbers draw_numbers(const Vector3& d, const std::array<double, 4>& u);
// Returns the chord through the point on the disc of the ball with the channel's reach.
ProbeRay probe_of(const Domain& domain, const ProbeNumbers& numbers);
// Returns the index of the picked hit; `count` > 0.
uint32_t picked_hit(double pick, uint32_t count);

// Returns the density per area of x2 by one axis and channel, including their probability but not
// the choice among hits.
double probe_technique_pdf(const Domain& domain, uint32_t axis, uint32_t channel,
                           const Vector3& position, const Vector3& normal);
// Returns the density over all axes and channels. Multiplied by one over the hit count of the
// traced probe, the density is the divisor of the estimate (the balance heuristic over axes and
// channels: each weight is alpha_t p_t / sum, without the other probes' hits).
double probe_pdf(const Domain& domain, const Vector3& position, const Vector3& normal);

// Probabilistic inversion (supplement, eq. 13 to 15): samples axis and channel with `u` by the
// probability that each led to x2, and recomputes radius and angle; `pick` stays 0. Returns false
// if no probe can reach x2.
bool invert_point(const Domain& domain, const Vector3& position, const Vector3& normal, double u,
                  ProbeNumbers& numbers);
// Returns the number that picks the hit on this primitive: (index + u) / count, with `u` uniform in
// [0, 1). Returns false if the probe misses the primitive.
bool invert_pick(const ProbeHits& hits, uint32_t instance, uint32_t primitive, double u,
                 double& pick);

} // namespace dermis::restir
