#pragma once

#include <cstdint>

namespace dermis {

// Returns the smallest multiple of `alignment` (at least 1) that is not below `value`.
constexpr uint64_t align_up(uint64_t value, uint64_t alignment) {
  return (value + alignment - 1) / alignment * alignment;
}

} // namespace dermis
