#pragma once
// Prefetching, branch-free selection and SIMD for the loops that `dermis bench compile` shows to
// need them. Internal to compile/. Without prefetching, compiling takes 6 % longer (median over the
// shapes and sizes of the bench; up to 13 %); without select() and SIMD 5 % (up to 21 %).

#include <concepts>
#include <cstdint>
#include <cstring>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace dermis {

// Loads a cache line that is needed soon.
inline void prefetch(const void* address) {
#if defined(__GNUC__)
  __builtin_prefetch(address);
#else
  static_cast<void>(address);
#endif
}

// Returns `a` if `first`, else `b`, without a branch, for unpredictable conditions where compilers
// branch on `?`.
template <std::unsigned_integral T> constexpr T select(bool first, T a, T b) {
  return static_cast<T>(b ^ ((a ^ b) & static_cast<T>(-static_cast<T>(first))));
}

// Number of masks that one call of any_common_bits tests.
inline constexpr uint32_t numbers_at_once = 32;

// any_common_bits without SIMD.
inline uint32_t any_common_bits_portable(const uint32_t* numbers, uint32_t mask) {
  uint8_t hit[numbers_at_once];
  for (uint32_t i = 0; i < numbers_at_once; ++i)
    hit[i] = (numbers[i] & mask) != 0 ? 1 : 0;
  uint32_t bits = 0;
  for (uint32_t part = 0; part < numbers_at_once / 8; ++part) {
    uint64_t bytes = 0;
    std::memcpy(&bytes, hit + size_t{part} * 8, sizeof bytes);
    bits |= static_cast<uint32_t>(bytes * 0x0102040810204080 >> 56)
            << (part * 8); // one bit of each byte
  }
  return bits;
}

// Returns a bit i for each numbers[i] that has a bit in common with `mask`.
inline uint32_t any_common_bits(const uint32_t* numbers, uint32_t mask) {
#if defined(__SSE2__)
  const __m128i masks = _mm_set1_epi32(static_cast<int>(mask)), none = _mm_setzero_si128();
  uint32_t missed = 0;
  for (uint32_t half = 0; half < 2; ++half) {
    const auto missing =
        [&](uint32_t quarter) { // all bits set for each of four numbers without a common bit
          const uint32_t* at = numbers + half * 16 + quarter * 4;
          return _mm_cmpeq_epi32(
              _mm_and_si128(_mm_loadu_si128(reinterpret_cast<const __m128i*>(at)), masks), none);
        };
    const __m128i low = _mm_packs_epi32(missing(0), missing(1));
    const __m128i high = _mm_packs_epi32(missing(2), missing(3));
    missed |= static_cast<uint32_t>(_mm_movemask_epi8(_mm_packs_epi16(low, high))) << (half * 16);
  }
  return ~missed;
#else
  return any_common_bits_portable(numbers, mask);
#endif
}

} // namespace dermis
