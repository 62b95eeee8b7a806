#pragma once
// Reservoirs: one path x2 - light with what is needed to shift it, its weight and how many samples it speaks
// for; 64 bytes packed. shaders/restir/reservoir.glsl mirrors these functions under the same names.
// Nothing that comes in makes a NaN, an infinity or a negative weight go out. Pure; thread: any.

#include "tests/passes/restir/cpu/probe.hpp"

#include <array>
#include <cstdint>

namespace dermis::restir {

inline constexpr uint32_t no_instance = 0xffffffff;

struct Reservoir {
  uint32_t instance = no_instance, primitive = 0; // x2; ids are integers from end to end
  Barycentrics barycentrics{};
  uint32_t light = 0, place = 0;
  ProbeNumbers numbers{}; // that lead from the own pixel's x1 to x2
  uint32_t hits = 0;      // of the probe that `numbers` stand for; 0: numbers are not known
  double density = 0;     // probe_pdf of x2 there, where hits > 0
  Vector3 irradiance{};   // at x2 from the light's place, visibility included
  double weight = 0;      // unbiased contribution weight: an estimate of 1 / density of the path
  double confidence = 0;  // samples it speaks for
};

// Holds a path that counts?
bool has_sample(const Reservoir& reservoir);

// What a reservoir may say after an untrusted journey: a sample with anything infinite, NaN or negative is
// none, a confidence is in [0, max_confidence], NaN counts as 0.
inline constexpr double max_confidence = 65536;
Reservoir sanitised(const Reservoir& reservoir);

// Words in the order of the members; axis, channel (2 bits each) and hits (8) share one, the rest are floats.
using PackedReservoir = std::array<uint32_t, 16>;
static_assert(sizeof(PackedReservoir) == 64);
PackedReservoir pack_reservoir(const Reservoir& reservoir);
Reservoir unpack_reservoir(const PackedReservoir& words); // sanitised

// Weighted reservoir sampling (Chao 1982; Bitterli et al. 2020), one candidate after the other.
struct Stream {
  Reservoir chosen;
  double sum = 0, target = 0; // of resampling weights; of the chosen one
  double confidence = 0;
};
// `weight` is MIS weight * target * contribution weight * Jacobian. Candidates whose weight or target is not
// positive and finite are passed over; their confidence counts all the same. u uniform in (0, 1).
void stream_add(Stream& stream, const Reservoir& candidate, double target, double weight, double confidence,
                double u);
// The chosen one with weight sum / target.
Reservoir stream_end(const Stream& stream);

// No history counts for more than this many times the frame (R11).
inline constexpr double confidence_cap = 20;

} // namespace dermis::restir
