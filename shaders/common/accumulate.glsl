// Mixes this frame's light with that of earlier frames. passes/common/accumulate.hpp has catmull_rom
// and the functions for sums, for tools.
#ifndef DERMIS_ACCUMULATE_GLSL
#define DERMIS_ACCUMULATE_GLSL

#include "constants.glsl"

// Returns the cubic weights of the four texels around a place (Catmull & Rom 1974), `part` texels
// beyond the second; their sum is 1. The outer two are negative, which keeps history sharp where
// bilinear weights would blur more in each frame.
vec4 catmull_rom(float part) {
  float t = part, t2 = t * t, t3 = t2 * t;
  return 0.5 *
         vec4(-t3 + 2.0 * t2 - t, 3.0 * t3 - 5.0 * t2 + 2.0, -3.0 * t3 + 4.0 * t2 + t, t3 - t2);
}

// A value accumulated over frames, and the number of these frames.
struct accumulated_light {
  vec3 light;
  float count;
};

// Variance clipping (Salvi 2016): moves history along the line to the mean of the neighbourhood
// until history is within `reach` standard deviations. The frame count shrinks by the same factor.
accumulated_light clip_to_neighbours(accumulated_light history, vec3 mean, vec3 deviation,
                                     float reach) {
  vec3 way = abs(history.light - mean), box_half = reach * deviation;
  float keep = 1.0;
  for (int c = 0; c < 3; ++c)
    if (way[c] > box_half[c])
      keep = min(keep, box_half[c] / way[c]);
  return accumulated_light(mix(mean, history.light, keep), history.count * keep);
}

// Returns the weight of a new frame against `count` frames of history. All frames weigh the same
// until the weight would fall below `minimum`.
float frame_weight(float count, float minimum) { return max(1.0 / (count + 1.0), minimum); }

accumulated_light add_frame(accumulated_light history, vec3 light, float minimum) {
  return accumulated_light(mix(history.light, light, frame_weight(history.count, minimum)),
                           min(history.count + 1.0, 1.0 / minimum));
}

// Returns the part of a pixel's scattered light that history keeps: the light that the nearest
// pixels do not explain, divided by the mean light around. The nearest pixels carry the sharp
// detail and are read again in each frame; the mean follows lights that change.
vec3 remainder_of(vec3 light, vec3 near, vec3 local_mean) {
  return (light - near) / max(local_mean, vec3(accumulate_min_mean));
}
bool can_be_kept(vec3 remainder) {
  return all(lessThanEqual(abs(remainder), vec3(accumulate_largest_remainder)));
}

// Returns the light that a remainder represents under the light of this frame.
vec3 light_of_remainder(vec3 remainder, vec3 near, vec3 local_mean) {
  return max(near + local_mean * remainder, vec3(0.0));
}

#endif
