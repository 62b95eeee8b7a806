// Groups of kernels whose block shape computes some blocks a second time, with more layers. Drivers
// on the CPU execute this step at least once, even if no invocation needs it. So an invocation first
// computes one block per round, and then all of its blocks that need the second step.
#ifndef DERMIS_SAP_ROUNDS_GLSL
#define DERMIS_SAP_ROUNDS_GLSL

layout(local_size_x = 64, local_size_x_id = 7) in;

const uint round_lanes = gl_WorkGroupSize.x;
// Blocks that an invocation computes; with 2x2 texels each, a mask of all texels has 32 bits.
const int block_rounds = 64 / int(round_lanes);

// Returns the block of the invocation, as listed_block() expects.
uint block_of_round(int round) { return gl_LocalInvocationIndex + round_lanes * uint(round); }

#endif
