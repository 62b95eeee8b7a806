// Random numbers by pixel and frame (pcg3d of Jarzynski & Olano 2020, "Hash functions for GPU
// rendering").
#ifndef DERMIS_HASH_GLSL
#define DERMIS_HASH_GLSL

uvec3 pcg3d(uvec3 v) {
  v = v * 1664525u + 1013904223u;
  v.x += v.y * v.z;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  v ^= v >> 16;
  v.x += v.y * v.z;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  return v;
}

// Returns values uniform in (0, 1), from the upper 24 bits.
vec3 unit_from_hash(uvec3 h) { return (vec3(h >> 8) + 0.5) * (1.0 / 16777216.0); }

#endif
