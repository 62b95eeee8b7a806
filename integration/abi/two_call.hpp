#pragma once
// The two-call array: items NULL returns the count; otherwise as many items as fit are written.

#include "integration/abi/failure.hpp"
#include "integration/abi/sized_struct.hpp"

#include <string>

namespace dermis::abi {

// `at(i)` returns item i. *count in: capacity of `items`; out: number of items.
template <class T, class At>
dermis_result fill_array(const Log& log, const char* what, uint32_t* count, T* items,
                         uint32_t available, At at) {
  if (count == nullptr) return bad_argument(log, "{}: count is NULL", what);
  if (items == nullptr) {
    *count = available;
    return DERMIS_OK;
  }
  const uint32_t capacity = *count;
  if (capacity > 0) {
    const size_t size = stated_size(items);
    if (const SizedRead read = check_size<T>(size); read != SizedRead::ok)
      return rejected_size(log, read, what, "array[0]", size, sizeof(T));
    auto* to = reinterpret_cast<std::byte*>(items);
    for (uint32_t i = 0; i < std::min(capacity, available); ++i)
      write_sized(to + i * size, size, T(at(i)));
  }
  *count = available;
  return capacity < available ? DERMIS_INCOMPLETE : DERMIS_OK;
}

// The two-call text: *size in: capacity of `text`; out: bytes needed, including the final 0.
inline dermis_result fill_text(const std::string& whole, size_t* size, char* text) {
  const size_t capacity = *size;
  *size = whole.size() + 1;
  if (text == nullptr) return DERMIS_OK;
  if (capacity < *size) return DERMIS_INCOMPLETE;
  std::memcpy(text, whole.c_str(), *size);
  return DERMIS_OK;
}

} // namespace dermis::abi
