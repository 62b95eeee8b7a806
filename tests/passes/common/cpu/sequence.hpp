#pragma once
// Sample points: the R2 sequence in 32-bit fixed point, with offsets by pcg3d16. Mirrors
// shaders/common/sequence.glsl under the same names. Thread: any.

#include "tests/passes/common/cpu/hash.hpp"

#include <array>
#include <cstdint>

namespace dermis::subsurface {

// 1/g and 1/g^2 in units of 2^-32, with g^3 = g + 1 (R2, Roberts 2018).
inline constexpr std::array<uint32_t, 2> r2_step = {3242174889u, 2447445414u};

// Returns the middle of a hash's cell, in units of 2^-32.
constexpr uint32_t offset_from_hash(uint32_t hash) {
  return hash << 16 | 0x8000u;
}

// Returns point `index` of R2 plus an offset, in units of 2^-32. Exact for every index: the product
// wraps where the sequence does.
constexpr std::array<uint32_t, 2> r2_point(std::array<uint32_t, 2> offset, uint32_t index) {
  return {offset[0] + index * r2_step[0], offset[1] + index * r2_step[1]};
}

} // namespace dermis::subsurface
