#pragma once
// Reservoirs: one path x2 - light with the data to shift it, its weight and its number of samples;
// 64 bytes packed. Any input gives weights that are finite, non-negative and not NaN.
// shaders/restir/reservoir.glsl mirrors these functions under the same names. Pure; thread: any.

#include "tests/passes/restir/cpu/probe.hpp"

#include <array>
#include <cstdint>

namespace dermis::restir {

inline constexpr uint32_t no_instance = 0xffffffff;

struct Reservoir {
  uint32_t instance = no_instance, primitive = 0; // x2; ids stay integers everywhere.
  Barycentrics barycentrics{};
  uint32_t light = 0, place = 0;
  ProbeNumbers numbers{}; // They lead from the x1 of the reservoir's pixel to x2.
  uint32_t hits = 0;      // Hit count of the probe of `numbers`; 0: the numbers are unknown.
  double density = 0;     // probe_pdf of x2 in that pixel, if hits > 0.
  Vector3 irradiance{};   // At x2 from the place on the light, including visibility.
  double weight = 0;      // Unbiased contribution weight: an estimate of 1 / density of the path.
  double confidence = 0;  // Number of samples that the reservoir represents.
};

// Returns whether the reservoir holds a path with a positive weight.
bool has_sample(const Reservoir& reservoir);

// Returns a valid reservoir for untrusted data: a sample with an infinite, NaN or negative value is
// dropped; the confidence is clamped to [0, max_confidence], and NaN becomes 0.
inline constexpr double max_confidence = 65536;
Reservoir sanitised(const Reservoir& reservoir);

// Words in the order of the members; axis, channel (2 bits each) and hits (8 bits) share one word,
// the rest are floats.
using PackedReservoir = std::array<uint32_t, 16>;
static_assert(sizeof(PackedReservoir) == 64);
PackedReservoir pack_reservoir(const Reservoir& reservoir);
Reservoir unpack_reservoir(const PackedReservoir& words); // Sanitises the result.

// Weighted reservoir sampling (Chao 1982; Bitterli et al. 2020) of one candidate after the other.
struct Stream {
  Reservoir chosen;
  double sum = 0, target = 0; // Sum of the resampling weights; target of the chosen candidate.
  double confidence = 0;
};
// `weight` is MIS weight * target * contribution weight * Jacobian. Candidates without a positive,
// finite weight and target are skipped, but their confidence is added. u is uniform in (0, 1).
void stream_add(Stream& stream, const Reservoir& candidate, double target, double weight,
                double confidence, double u);
// Returns the chosen candidate with weight sum / target.
Reservoir stream_end(const Stream& stream);

// The confidence of a history is at most this many times the frame's confidence.
inline constexpr double confidence_cap = 20;

} // namespace dermis::restir
