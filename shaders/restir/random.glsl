// Random numbers of a pixel: a key and a counter. tests/passes/restir/cpu/random.hpp mirrors these
// functions bit for bit under the same names.
#ifndef DERMIS_RESTIR_RANDOM_GLSL
#define DERMIS_RESTIR_RANDOM_GLSL

#include "common/hash.glsl"

struct random_state {
  uint pixel; // a number unique to the pixel
  uint frame;
  // Count of numbers used; passes of one frame begin at multiples of random_numbers_a_pass.
  uint count;
};
const uint random_numbers_a_pass = 1024u;
// restir.initial begins here and may use more than random_numbers_a_pass.
const uint random_numbers_of_samples = 4u * random_numbers_a_pass;

// Returns a number uniform in (0, 1) with 24 bits.
float random_unit(inout random_state random) {
  uint bits = pcg3d(uvec3(random.pixel, random.frame, random.count)).x;
  random.count += 1u;
  return (float(bits >> 8) + 0.5) * (1.0 / 16777216.0);
}

#endif
