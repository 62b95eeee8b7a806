// Weights of a level's tent if pixels are not square; mirrors SapShape::tent
// (passes/sap/sap_weights.cpp).
#ifndef DERMIS_SAP_TENT_GLSL
#define DERMIS_SAP_TENT_GLSL

#include "sap/sap.glsl"

// Weights at the distances of 0, 1 and 2 texels.
struct sap_tent_weights {
  vec3 across, down;
};

vec3 tent_of_variance(float variance, bool three_taps) {
  float more = variance - 0.5;
  return three_taps || more <= 0.0 ? vec3(1.0 - variance, 0.5 * variance, 0.0)
                                   : vec3(0.5 - 0.25 * more, 0.25, 0.125 * more);
}

// Returns the weights for the shape of the frame's pixels.
sap_tent_weights sap_tent_of_level(int level) {
  vec2 spacing = sap_spacings(level), squares = spacing * spacing;
  vec2 before = 0.5 - 0.5 / squares; // variance of the steps to the level
  vec2 sides = squares * frame.ray_scale * frame.ray_scale;
  float wide = ((before.y + 1.0) * sides.y - before.x * sides.x) / (sides.x + sides.y);
  bool three_taps = level >= sap_first_short_tent;
  float limit = three_taps ? sap_max_short_variance : 1.0;
  float across = clamp(wide, 1.0 - limit, limit);
  return sap_tent_weights(tent_of_variance(across, three_taps),
                          tent_of_variance(1.0 - across, three_taps));
}

#endif
