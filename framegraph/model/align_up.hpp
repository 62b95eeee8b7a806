#pragma once

#include <cstdint>

namespace dermis {

constexpr uint64_t ceil_div(uint64_t value, uint64_t by) {
  return (value + by - 1) / by;
}

// Returns the smallest multiple of `alignment` (at least 1) that is not below `value`.
constexpr uint64_t align_up(uint64_t value, uint64_t alignment) {
  return ceil_div(value, alignment) * alignment;
}

} // namespace dermis
