// Workgroups of kernels whose block shape computes some texels in a second step, with two layers.
// CPU drivers execute this step at least once, even if no invocation needs it, and as often as the
// invocation that needs it most. So each invocation first computes one block per round; then the
// group divides the texels that need the second step among its invocations.
#ifndef DERMIS_SAP_ROUNDS_GLSL
#define DERMIS_SAP_ROUNDS_GLSL

#extension GL_EXT_control_flow_attributes : require
#include "common/shape.glsl"

layout(local_size_x = 64, local_size_x_id = 7) in;

// At least 8, because a mask has a bit for each of the 2x2 texels of the blocks of all rounds.
const uint round_lanes = gl_WorkGroupSize.x;
const int block_rounds = 64 / int(round_lanes);

// Returns the block of the invocation, as listed_block() expects.
uint block_of_round(int round) { return gl_LocalInvocationIndex + round_lanes * uint(round); }

// Element 0: number of texels of the group that need the second step. From element 4 on: 4 b + k
// for texel k of block b. Elements 1 to 3 keep other shared memory aligned.
const uint first_again = 4u;
shared uint texels_again[first_again + (texel_shape ? 0u : 4u * 64u)];

uint count_again() { return texels_again[0]; }
// Returns texel i < count_again().
uint texel_again(uint i) { return texels_again[first_again + i]; }

// All invocations of the group call both functions.
void begin_rounds() {
  if (gl_LocalInvocationIndex == 0u)
    texels_again[0] = 0u;
  barrier();
}
// Lists texels of the invocation: bit 4 r + k of the mask for texel k of round r.
void finish_rounds(uint again) {
  uint place = first_again + atomicAdd(texels_again[0], uint(bitCount(again)));
  [[dont_unroll]] for (; again != 0u; again &= again - 1u, ++place) {
    int next = findLSB(again);
    texels_again[place] = 4u * block_of_round(next >> 2) + uint(next & 3);
  }
  barrier();
}

#endif
