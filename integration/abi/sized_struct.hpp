#pragma once
// Structs of the C interface start with `struct_size`. Reading accepts a struct of a newer header
// if the part that this library does not know is zero.

#include "integration/include/dermis/dermis.h"

#include <cstddef>
#include <cstring>

namespace dermis::abi {

enum class SizedRead { ok, too_small, too_large, unknown_fields };

// No struct of the interface comes near; a larger size is uninitialised memory and must not be read
// through.
inline constexpr size_t largest_struct_size = 4096;

inline size_t stated_size(const void* structure) {
  size_t size = 0;
  std::memcpy(&size, structure, sizeof size);
  return size;
}

template <class T> SizedRead check_size(size_t size) {
  if (size < sizeof(T)) return SizedRead::too_small;
  return size > largest_struct_size ? SizedRead::too_large : SizedRead::ok;
}

// Reads *from, which need not be aligned.
template <class T> SizedRead read_sized(const void* from, T& to) {
  const size_t size = stated_size(from);
  if (const SizedRead checked = check_size<T>(size); checked != SizedRead::ok) return checked;
  const auto* bytes = static_cast<const std::byte*>(from);
  for (size_t i = sizeof(T); i < size; ++i)
    if (bytes[i] != std::byte{0}) return SizedRead::unknown_fields;
  std::memcpy(&to, bytes, sizeof(T));
  to.struct_size = sizeof(T);
  return SizedRead::ok;
}

// Returns element i of a caller's array, whose stride is the first element's struct_size.
inline const void* element(const void* items, uint32_t i) {
  return static_cast<const std::byte*>(items) + i * stated_size(items);
}

// Reads one element of an array, all of which have the size that the first one states.
template <class T> SizedRead read_element(const T* items, uint32_t i, T& to) {
  const void* from = element(items, i);
  return stated_size(from) == stated_size(items) ? read_sized(from, to) : SizedRead::too_small;
}

// Writes `value` to a struct of `size` bytes, at least sizeof(T); fields that this library does not
// know become zero.
template <class T> void write_sized(void* to, size_t size, T value) {
  value.struct_size = size;
  auto* bytes = static_cast<std::byte*>(to);
  std::memcpy(bytes, &value, sizeof(T));
  if (size > sizeof(T)) std::memset(bytes + sizeof(T), 0, size - sizeof(T));
}

} // namespace dermis::abi
