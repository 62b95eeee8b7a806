// The scatter domain: the part of a path camera - x1 - x2 - light that the pixel determines.
// tests/passes/restir/cpu/domain.cpp mirrors and documents these functions in fp64 under the same
// names. All lengths are in the same unit.
#ifndef DERMIS_RESTIR_DOMAIN_GLSL
#define DERMIS_RESTIR_DOMAIN_GLSL

#include "common/constants_math.glsl"
#include "common/burley.glsl"

struct scatter_domain {
  vec3 position; // x1
  vec3 normal;   // unit length: the first axis of the domain's probes
  vec3 d;        // Burley's shape parameter per channel; 0: the channel does not scatter
  uint medium;   // profile id; 0: none
};

// 32 bytes; the normal has 16 bits for each of two coordinates.
struct packed_domain {
  uvec4 words[2];
};

const float restir_pi = 3.14159265358979;
const float probe_fraction = 0.999;            // fraction of a channel's energy that probes reach
// Radius of this fraction: 1 - probe_fraction = (e^-r + 3 e^(-r/3)) / 4.
const float reach_in_d = 19.8602213973662;
const float min_radius_in_d = 1e-6;       // R is infinite at 0; smaller radii are clamped to this

float scattering_reach(vec3 d) { return reach_in_d * max(d.r, max(d.g, d.b)); }

// Returns R(r), per unit of area.
float burley_R(float r, float d) { return burley_pdf(r, d) / (2.0 * restir_pi * r); }

// Returns the fraction of the energy within r, in the unit of d. Exact for small r, where 1 - exp
// loses digits.
float burley_cdf(float r, float d) {
  float x = r / (3.0 * d);
  if (x < 0.01) // series of 1 - e^(-3x)/4 - 3 e^(-x)/4 = 3x/2 - 3x^2/2 + 5x^3/4 - ...
    return x * (1.5 - x * (1.5 - 1.25 * x));
  float t = exp(-x);
  return 1.0 - 0.25 * t * t * t - 0.75 * t;
}

// Returns R_c(r) / cdf_c(reach) up to the reach of the widest channel; 0 beyond the reach, and
// where d is 0.
vec3 scattering_profile(vec3 d, float r) {
  float reach = scattering_reach(d);
  vec3 profile = vec3(0.0);
  if (!(r <= reach))
    return profile;
  for (int c = 0; c < 3; ++c)
    if (d[c] > 0.0)
      profile[c] = burley_R(max(r, min_radius_in_d * d[c]), d[c]) / burley_cdf(reach, d[c]);
  return profile;
}

// Returns the normal or one of two tangents (Duff et al. 2017), by axis % 3.
vec3 probe_axis(vec3 normal, uint axis) {
  float up = normal.z >= 0.0 ? 1.0 : -1.0;
  float a = -1.0 / (up + normal.z), b = normal.x * normal.y * a;
  if (axis == 1u)
    return vec3(1.0 + up * normal.x * normal.x * a, up * b, -up * normal.x);
  if (axis == 2u)
    return vec3(b, up + normal.y * normal.y * a, -normal.y);
  return normal;
}

// Returns the light that reaches x1 from this irradiance at distance r: diffuse light before
// albedo.
vec3 scattered(scatter_domain domain, float r, vec3 irradiance) {
  return scattering_profile(domain.d, r) * irradiance;
}

// Maps a unit vector to a square by the faces of an octahedron (Cigolle et al. 2014, "A Survey of
// Efficient Representations for Independent Unit Vectors").
vec2 fold_normal(vec3 n) {
  vec2 flat_part = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
  vec2 side = mix(vec2(-1.0), vec2(1.0), greaterThanEqual(flat_part, vec2(0.0)));
  return n.z >= 0.0 ? flat_part : (1.0 - abs(flat_part.yx)) * side;
}
vec3 unfold_normal(vec2 p) {
  vec3 n = vec3(p, 1.0 - abs(p.x) - abs(p.y));
  vec2 side = mix(vec2(-1.0), vec2(1.0), greaterThanEqual(p, vec2(0.0)));
  if (n.z < 0.0)
    n.xy = (1.0 - abs(p.yx)) * side;
  return normalize(n);
}

packed_domain pack_domain(scatter_domain domain) {
  packed_domain packed;
  packed.words[0] = uvec4(floatBitsToUint(domain.position), domain.medium);
  packed.words[1] = uvec4(floatBitsToUint(domain.d), packSnorm2x16(fold_normal(domain.normal)));
  return packed;
}
scatter_domain unpack_domain(packed_domain packed) {
  return scatter_domain(uintBitsToFloat(packed.words[0].xyz),
                        unfold_normal(unpackSnorm2x16(packed.words[1].w)),
                        uintBitsToFloat(packed.words[1].xyz), packed.words[0].w);
}

float luminance(vec3 rgb) { return dot(rgb, luminance_weights); }

#endif
