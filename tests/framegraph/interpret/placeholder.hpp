#pragma once
// Arithmetic in place of kernels: small images whose every pixel tells what it was computed from. Two
// computations that agree on all pixels did the same work on the same inputs, but for collisions of 64 bits.

#include <array>
#include <cstdint>
#include <span>

namespace dermis {

using Pixels = std::array<uint64_t, 8>; // every buffer and every mip of a layer, whatever its size

struct StandInInput {
  uint32_t port = 0;
  Pixels pixels{};
};

// Pixels that depend on `seed` and `stream` alone: contents of the host, or contents that mean nothing.
Pixels arbitrary_pixels(uint64_t seed, uint64_t stream);

// What pass number `pass` writes to `port` from these inputs, in the order given; to the mip and layer number
// `part` of those that the port sees. Each pixel depends on
// several pixels of every input. Settings have no part in it.
Pixels placeholder(uint32_t pass, uint32_t port, uint32_t part, std::span<const StandInInput> inputs);

} // namespace dermis
