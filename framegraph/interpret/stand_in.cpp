#include "framegraph/interpret/stand_in.hpp"

namespace dermis {
namespace {

// SplitMix64 (Steele, Lea, Flood 2014), its output function.
uint64_t scramble(uint64_t z) {
  z += 0x9e3779b97f4a7c15ull;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return z ^ (z >> 31);
}

uint64_t mix(uint64_t sum, uint64_t value) {
  return scramble(sum ^ scramble(value));
}

constexpr size_t neighbours[] = {0, 1, 3}; // pixels ahead: a stencil that is not symmetric

} // namespace

Pixels arbitrary_pixels(uint64_t seed, uint64_t stream) {
  Pixels out{};
  for (size_t i = 0; i < out.size(); ++i)
    out[i] = mix(mix(seed, stream), i);
  return out;
}

Pixels stand_in(uint32_t pass, uint32_t port, std::span<const StandInInput> inputs) {
  Pixels out{};
  for (size_t i = 0; i < out.size(); ++i) {
    uint64_t sum = mix(mix(pass, port), i);
    for (const StandInInput& input : inputs) {
      sum = mix(sum, input.port);
      for (const size_t ahead : neighbours)
        sum = mix(sum, input.pixels[(i + ahead) % input.pixels.size()]);
    }
    out[i] = sum;
  }
  return out;
}

} // namespace dermis
