#pragma once
// Random numbers by pixel and frame (Jarzynski & Olano 2020, "Hash functions for GPU rendering").
// Mirrors shaders/common/hash.glsl; pcg3d16 mirrors sequence.glsl. Names are equal. Thread: any.

#include <array>
#include <cstdint>

namespace dermis::subsurface {

using Hash = std::array<uint32_t, 3>;

constexpr Hash pcg3d_step(Hash v) {
  for (uint32_t& one : v)
    one = one * 1664525u + 1013904223u;
  return v;
}
constexpr Hash pcg3d_mix(Hash v) {
  v[0] += v[1] * v[2];
  v[1] += v[2] * v[0];
  v[2] += v[0] * v[1];
  return v;
}

// Returns three hashes of 32 bits.
constexpr Hash pcg3d(Hash v) {
  v = pcg3d_mix(pcg3d_step(v));
  for (uint32_t& one : v)
    one ^= one >> 16;
  return pcg3d_mix(v);
}

// Returns three hashes of 16 bits.
constexpr Hash pcg3d16(Hash v) {
  v = pcg3d_mix(pcg3d_mix(pcg3d_step(v)));
  return {v[0] >> 16, v[1] >> 16, v[2] >> 16};
}

} // namespace dermis::subsurface
