#pragma once
// Arithmetic in place of kernels, on small images whose pixels are hashes of all inputs. Two
// computations with equal pixels did the same work on the same inputs, except for collisions of 64
// bits.

#include <array>
#include <cstdint>
#include <span>

namespace dermis {

// Used for every buffer and every mip of a layer, whatever its size.
using Pixels = std::array<uint64_t, 8>;

struct PlaceholderInput {
  uint32_t port = 0;
  Pixels pixels{};
};

// Returns pixels that depend only on `seed` and `stream`: contents of the host, or undefined
// contents.
Pixels arbitrary_pixels(uint64_t seed, uint64_t stream);

// Returns the pixels that pass number `pass` writes to `port` from these inputs, in this order.
// `part` is the index of the mip and layer among those of the port. Each pixel depends on several
// pixels of every input. Settings have no effect.
Pixels placeholder(uint32_t pass, uint32_t port, uint32_t part,
                   std::span<const PlaceholderInput> inputs);

} // namespace dermis
