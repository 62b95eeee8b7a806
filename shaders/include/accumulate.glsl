// Mixing this frame's light into that of earlier frames. passes/subsurface/temporal/accumulate.hpp mirrors these
// functions under the same names.
#ifndef DERMIS_ACCUMULATE_GLSL
#define DERMIS_ACCUMULATE_GLSL

#include "constants.glsl"

// Cubic weights of the four texels around a place (Catmull & Rom 1974), `part` beyond the second; sum 1. The outer two
// are negative: what bilinear weights blur from frame to frame stays sharp.
vec4 catmull_rom(float part) {
  float t = part, t2 = t * t, t3 = t2 * t;
  return 0.5 * vec4(-t3 + 2.0 * t2 - t, 3.0 * t3 - 5.0 * t2 + 2.0, -3.0 * t3 + 4.0 * t2 + t, t3 - t2);
}

// Light, and frames behind it.
struct accumulated_light {
  vec3 light;
  float count;
};

// Variance clipping (Salvi 2016): history is drawn along the line to the neighbourhood's mean until it lies within
// `reach` of its standard deviations, and counts for as much less as it was drawn.
accumulated_light clip_to_neighbours(accumulated_light history, vec3 mean, vec3 deviation, float reach) {
  vec3 way = abs(history.light - mean), room = reach * deviation;
  float keep = 1.0;
  for (int c = 0; c < 3; ++c)
    if (way[c] > room[c])
      keep = min(keep, room[c] / way[c]);
  return accumulated_light(mix(mean, history.light, keep), history.count * keep);
}

// Light of pixels whose surfaces were seen in the frame before as well: sums over them.
struct light_pairs {
  vec3 now, before, now_squared, product, before_squared;
  float pixels;
};
light_pairs no_pairs() { return light_pairs(vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), 0.0); }
void add_pixel(inout light_pairs pairs, vec3 now, vec3 before) {
  pairs.now += now;
  pairs.before += before;
  pairs.now_squared += now * now;
  pairs.product += now * before;
  pairs.before_squared += before * before;
  pairs.pixels += 1.0;
}

// By how much all light of those pixels became brighter; 1 where what they differ by among each other explains it, as
// noise of samples and shadows that move do, and where nothing was lit.
vec3 brightness_change(light_pairs pairs) {
  vec3 change = vec3(1.0);
  if (pairs.pixels < change_least_pixels)
    return change;
  for (int c = 0; c < 3; ++c) {
    if (!(pairs.before[c] > 0.0))
      continue;
    float factor = pairs.now[c] / pairs.before[c];
    // Of what the factor leaves between the pixels; that of their mean, as a factor.
    float variance = max(pairs.now_squared[c] - 2.0 * factor * pairs.product[c] + factor * factor * pairs.before_squared[c], 0.0) /
                     (pairs.pixels - 1.0);
    float error = variance * pairs.pixels / (pairs.before[c] * pairs.before[c]);
    float way = (factor - 1.0) * (factor - 1.0), doubtful = change_sigmas * change_sigmas * error;
    if (way > doubtful)
      change[c] = 1.0 + (1.0 - doubtful / way) * (factor - 1.0);
  }
  return change;
}

// A mean of all frames until they weigh less than `least` each, then a moving one.
accumulated_light add_frame(accumulated_light history, vec3 light, float least) {
  float weight = max(1.0 / (history.count + 1.0), least);
  return accumulated_light(mix(history.light, light, weight), min(history.count + 1.0, 1.0 / least));
}

#endif
