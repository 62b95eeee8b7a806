#include "tests/framegraph/interpret/placeholder.hpp"

#include "framegraph/model/splitmix.hpp"

namespace dermis {
namespace {

uint64_t scramble(uint64_t z) {
  return splitmix_scramble(z + splitmix_step);
}

uint64_t mix(uint64_t sum, uint64_t value) {
  return scramble(sum ^ scramble(value));
}

constexpr size_t neighbours[] = {0, 1, 3}; // Offsets in pixels; the stencil is not symmetric.

} // namespace

Pixels arbitrary_pixels(uint64_t seed, uint64_t stream) {
  Pixels out{};
  for (size_t i = 0; i < out.size(); ++i)
    out[i] = mix(mix(seed, stream), i);
  return out;
}

Pixels placeholder(uint32_t pass, uint32_t port, uint32_t part,
                   std::span<const PlaceholderInput> inputs) {
  Pixels out{};
  for (size_t i = 0; i < out.size(); ++i) {
    uint64_t sum = mix(mix(mix(pass, port), part), i);
    for (const PlaceholderInput& input : inputs) {
      sum = mix(sum, input.port);
      for (const size_t ahead : neighbours)
        sum = mix(sum, input.pixels[(i + ahead) % input.pixels.size()]);
    }
    out[i] = sum;
  }
  return out;
}

} // namespace dermis
