// Repeatable noise on object-space positions.

// pcg3d of Jarzynski and Olano 2020, "Hash Functions for GPU Rendering".
uvec3 pcg3d(uvec3 v) {
  v = v * 1664525u + 1013904223u;
  v.x += v.y * v.z;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  v ^= v >> 16u;
  v.x += v.y * v.z;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  return v;
}

vec3 hash3(ivec3 cell) { return vec3(pcg3d(uvec3(cell)) >> 8u) * (1.0 / 16777216.0); }

// Returns three independent smooth values in [0, 1].
vec3 noise3(vec3 p) {
  ivec3 cell = ivec3(floor(p));
  vec3 f = p - vec3(cell);
  vec3 w = f * f * (3.0 - 2.0 * f);
  vec3 near = mix(mix(hash3(cell), hash3(cell + ivec3(1, 0, 0)), w.x),
                  mix(hash3(cell + ivec3(0, 1, 0)), hash3(cell + ivec3(1, 1, 0)), w.x), w.y);
  vec3 far = mix(mix(hash3(cell + ivec3(0, 0, 1)), hash3(cell + ivec3(1, 0, 1)), w.x),
                 mix(hash3(cell + ivec3(0, 1, 1)), hash3(cell + ivec3(1, 1, 1)), w.x), w.y);
  return mix(near, far, w.z);
}

// Returns the distance of p from the nearest of one point per cell, and that point's number in [0,
// 1].
vec2 speckle(vec3 p) {
  ivec3 cell = ivec3(floor(p));
  vec2 nearest = vec2(8.0, 0.0);
  for (int i = 0; i < 8; ++i) {
    ivec3 other = cell + ivec3(i & 1, (i >> 1) & 1, i >> 2) - ivec3(lessThan(fract(p), vec3(0.5)));
    vec3 random = hash3(other);
    float d = length(vec3(other) + 0.25 + 0.5 * random - p);
    if (d < nearest.x) nearest = vec2(d, fract(random.x * 61.0));
  }
  return nearest;
}
