// Mixing this frame's light into that of earlier frames. passes/subsurface/temporal/accumulate.hpp mirrors these
// functions under the same names.
#ifndef DERMIS_ACCUMULATE_GLSL
#define DERMIS_ACCUMULATE_GLSL

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

// A mean of all frames until they weigh less than `least` each, then a moving one.
accumulated_light add_frame(accumulated_light history, vec3 light, float least) {
  float weight = max(1.0 / (history.count + 1.0), least);
  return accumulated_light(mix(history.light, light, weight), min(history.count + 1.0, 1.0 / least));
}

#endif
