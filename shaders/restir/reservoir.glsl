// Reservoirs: one path x2 - light, its weight and its confidence; 64 bytes packed.
// tests/passes/restir/cpu/reservoir.cpp mirrors and documents these functions in fp64 under the
// same names.
#ifndef DERMIS_RESTIR_RESERVOIR_GLSL
#define DERMIS_RESTIR_RESERVOIR_GLSL

#include "restir/probe.glsl"

const uint no_instance = 0xffffffffu;
const float max_confidence = 65536.0;
const float confidence_cap = 20.0;

struct reservoir {
  uint instance, primitive; // x2
  vec2 barycentrics;
  uint light, place;
  probe_numbers numbers; // lead from the pixel's own x1 to x2
  uint hits;             // number of hits of this probe; 0: numbers are unknown
  float density;         // probe_pdf of x2 in its own pixel; valid if hits > 0
  vec3 irradiance;       // irradiance at x2 from the light's place, including visibility
  float weight;          // unbiased contribution weight
  float confidence;
};

struct packed_reservoir {
  uvec4 words[4];
};

reservoir no_reservoir(float confidence) {
  return reservoir(no_instance, 0u, vec2(0.0), 0u, 0u, probe_numbers(0u, 0u, 1.0, 0.0, 0.0), 0u,
                   0.0, vec3(0.0), 0.0, confidence);
}

bool has_sample(reservoir r) { return r.instance != no_instance && r.weight > 0.0; }

const float restir_largest = 3.0e38; // larger values are treated as infinite
bool is_usable(float x) { return x >= 0.0 && x < restir_largest; }

reservoir sanitised(reservoir r) {
  r.confidence = r.confidence > 0.0 ? min(r.confidence, max_confidence) : 0.0;
  bool good = is_usable(r.weight) && is_usable(r.density) && is_usable(r.irradiance.r) &&
              is_usable(r.irradiance.g) && is_usable(r.irradiance.b);
  float fractions[5] = float[5](r.barycentrics.x, r.barycentrics.y, r.numbers.survival,
                                r.numbers.angle, r.numbers.pick);
  for (int i = 0; i < 5; ++i)
    good = good && fractions[i] >= 0.0 && fractions[i] <= 1.0;
  good = good && r.numbers.axis < 3u && r.numbers.channel < 3u &&
         (r.hits <= max_probe_hits || r.hits == assumed_hits);
  if (good)
    return r;
  return no_reservoir(r.confidence);
}

packed_reservoir pack_reservoir(reservoir r) {
  packed_reservoir result;
  result.words[0] = uvec4(r.instance, r.primitive, floatBitsToUint(r.barycentrics));
  result.words[1] = uvec4(r.light, r.place, r.numbers.axis | r.numbers.channel << 2 | r.hits << 4,
                          floatBitsToUint(r.numbers.survival));
  result.words[2] =
      uvec4(floatBitsToUint(vec4(r.numbers.angle, r.numbers.pick, r.density, r.irradiance.r)));
  result.words[3] = uvec4(floatBitsToUint(vec4(r.irradiance.gb, r.weight, r.confidence)));
  return result;
}

reservoir unpack_reservoir(packed_reservoir p) {
  reservoir r;
  r.instance = p.words[0].x;
  r.primitive = p.words[0].y;
  r.barycentrics = uintBitsToFloat(p.words[0].zw);
  r.light = p.words[1].x;
  r.place = p.words[1].y;
  r.numbers =
      probe_numbers(p.words[1].z & 3u, p.words[1].z >> 2 & 3u, uintBitsToFloat(p.words[1].w),
                    uintBitsToFloat(p.words[2].x), uintBitsToFloat(p.words[2].y));
  r.hits = p.words[1].z >> 4 & 255u;
  r.density = uintBitsToFloat(p.words[2].z);
  r.irradiance = uintBitsToFloat(uvec3(p.words[2].w, p.words[3].xy));
  r.weight = uintBitsToFloat(p.words[3].z);
  r.confidence = uintBitsToFloat(p.words[3].w);
  return sanitised(r);
}

struct reservoir_stream {
  reservoir chosen;
  float sum, target; // sum of resampling weights; target of the chosen path
  float confidence;
};

reservoir_stream stream_begin() { return reservoir_stream(no_reservoir(0.0), 0.0, 0.0, 0.0); }

// Adds a candidate. `weight` is MIS weight * target * contribution weight * Jacobian; u is uniform
// in (0, 1).
void stream_add(inout reservoir_stream stream, reservoir candidate, float target, float weight,
                float confidence, float u) {
  stream.confidence += confidence;
  if (!(weight > 0.0) || !(target > 0.0) || !is_usable(weight) || !is_usable(target))
    return;
  stream.sum += weight;
  if (!(u * stream.sum < weight))
    return;
  stream.chosen = candidate;
  stream.target = target;
}

reservoir stream_end(reservoir_stream stream) {
  reservoir result = stream.chosen;
  result.confidence = stream.confidence;
  result.weight = stream.target > 0.0 ? stream.sum / stream.target : 0.0;
  return sanitised(result);
}

#endif
