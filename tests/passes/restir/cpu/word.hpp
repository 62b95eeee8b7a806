#pragma once
// Converts numbers to words of buffers: the bits of a float.

#include <bit>
#include <cstdint>

namespace dermis::restir {

inline uint32_t bits(double x) {
  return std::bit_cast<uint32_t>(static_cast<float>(x));
}
inline double number(uint32_t word) {
  return static_cast<double>(std::bit_cast<float>(word));
}

} // namespace dermis::restir
