// Sample points: R2 in 32-bit fixed point, with offsets from pcg3d16.
// tests/passes/common/cpu/sequence.hpp mirrors these functions under the same names.
#ifndef DERMIS_SEQUENCE_GLSL
#define DERMIS_SEQUENCE_GLSL

// R2 (Roberts 2018): multiples of 1/g and 1/g^2 with g^3 = g + 1, as integers in units of 2^-32. No
// index loses digits, because index * step wraps where the sequence does.
const uvec2 r2_step = uvec2(3242174889u, 2447445414u);

// Returns three hashes of 16 bits (Jarzynski & Olano 2020, pcg3d16).
uvec3 pcg3d16(uvec3 v) {
  v = v * 1664525u + 1013904223u;
  v.x += v.y * v.z;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  v.x += v.y * v.z;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  return v >> 16;
}

// Returns the middle of a hash's cell, in units of 2^-32.
uvec2 offset_from_hash(uvec2 hash) { return (hash << 16) | 0x8000u; }

// Returns point `index` of R2 plus an offset, in units of 2^-32.
uvec2 r2_point(uvec2 offset, uint index) { return offset + index * r2_step; }

// Returns values uniform in (0, 1), from the upper 24 bits.
vec2 unit_from_fixed(uvec2 v) { return (vec2(v >> 8) + 0.5) * (1.0 / 16777216.0); }

#endif
