#pragma once
// SplitMix64 (Steele, Lea, Flood 2014): yields equal numbers with every standard library.

#include <cstddef>
#include <cstdint>

namespace dermis {

inline constexpr uint64_t splitmix_step = 0x9e3779b97f4a7c15ull; // 2^64 / golden ratio

// Output function: a bijection of 64-bit words in which each output bit depends on all input bits.
constexpr uint64_t splitmix_scramble(uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return z ^ (z >> 31);
}

struct SplitMix64 {
  uint64_t state = 0;

  constexpr uint64_t next() { return splitmix_scramble(state += splitmix_step); }
  // Returns a number in 0 .. limit - 1, for limit >= 1; biased by limit / 2^64.
  constexpr size_t below(size_t limit) { return static_cast<size_t>(next() % limit); }
};

} // namespace dermis
