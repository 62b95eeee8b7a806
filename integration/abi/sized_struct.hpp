#pragma once
// Structs that cross the border start with `struct_size`. Reading takes what both sides know, keeps the
// defaults for the rest and refuses a tail that means something to the caller and nothing to us.

#include "integration/include/dermis/dermis.h"

#include <algorithm>
#include <cstddef>
#include <cstring>

namespace dermis::abi {

enum class SizedRead { ok, too_small, too_large, unknown_fields };

// No struct of the interface comes near; a larger size is uninitialised memory and must not be read through.
inline constexpr size_t largest_struct_size = 4096;

// Bytes of the first version of each struct: a caller who states less cannot have used a header of ours.
template <class T> inline constexpr size_t first_version_size = 0;
template <>
inline constexpr size_t first_version_size<dermis_message> = offsetof(dermis_message, hint) +
                                                             sizeof(const char*);
template <>
inline constexpr size_t first_version_size<dermis_requirement> = offsetof(dermis_requirement, why) +
                                                                 sizeof(const char*);
template <>
inline constexpr size_t first_version_size<dermis_context_desc> = offsetof(dermis_context_desc, log_user) +
                                                                  sizeof(void*);
template <>
inline constexpr size_t first_version_size<dermis_source> = offsetof(dermis_source, length) + sizeof(size_t);
template <>
inline constexpr size_t first_version_size<dermis_profile> = offsetof(dermis_profile, source) +
                                                             sizeof(dermis_source);
template <>
inline constexpr size_t first_version_size<dermis_slot_format> = offsetof(dermis_slot_format, reserved) +
                                                                 sizeof(uint32_t);
template <>
inline constexpr size_t first_version_size<dermis_graph_desc> = offsetof(dermis_graph_desc, keep) +
                                                                sizeof(uint32_t);
template <>
inline constexpr size_t first_version_size<dermis_slot> = offsetof(dermis_slot, bound) + sizeof(uint32_t);
template <>
inline constexpr size_t first_version_size<dermis_memory> = offsetof(dermis_memory, constant_bytes) +
                                                            sizeof(uint64_t);
template <>
inline constexpr size_t first_version_size<dermis_pass_timing> = offsetof(dermis_pass_timing, nanoseconds) +
                                                                 sizeof(uint64_t);
template <>
inline constexpr size_t first_version_size<dermis_setting> = offsetof(dermis_setting, options) +
                                                             sizeof(const char* const*);
template <>
inline constexpr size_t first_version_size<dermis_budget> = offsetof(dermis_budget, calibration) +
                                                            sizeof(const dermis_source*);
template <>
inline constexpr size_t first_version_size<dermis_choice> = offsetof(dermis_choice, reserved) +
                                                            sizeof(uint32_t);
template <>
inline constexpr size_t first_version_size<dermis_port> = offsetof(dermis_port, own_texels) +
                                                          sizeof(uint32_t);
template <>
inline constexpr size_t first_version_size<dermis_pass_setting> = offsetof(dermis_pass_setting, maximum) +
                                                                  sizeof(double);
template <>
inline constexpr size_t first_version_size<dermis_pass_type> = offsetof(dermis_pass_type, user) +
                                                               sizeof(void*);
template <>
inline constexpr size_t first_version_size<dermis_image_binding> = offsetof(dermis_image_binding, after) +
                                                                   sizeof(dermis_image_state);
template <>
inline constexpr size_t first_version_size<dermis_buffer_binding> = offsetof(dermis_buffer_binding, after) +
                                                                    sizeof(dermis_image_state);
template <>
inline constexpr size_t first_version_size<dermis_acceleration_structure_binding> =
    offsetof(dermis_acceleration_structure_binding, after) + sizeof(dermis_image_state);
template <>
inline constexpr size_t first_version_size<dermis_frame> = offsetof(dermis_frame, depth_kind) +
                                                           sizeof(dermis_depth_kind);

template <>
inline constexpr size_t first_version_size<dermis_view_desc> = offsetof(dermis_view_desc, user) +
                                                               sizeof(void*);

template <>
inline constexpr size_t first_version_size<dermis_allocator> = offsetof(dermis_allocator, user) +
                                                               sizeof(void*);
template <>
inline constexpr size_t
    first_version_size<dermis_device_allocator> = offsetof(dermis_device_allocator, user) + sizeof(void*);
template <>
inline constexpr size_t first_version_size<dermis_memory_request> = offsetof(dermis_memory_request,
                                                                             preferred) +
                                                                    sizeof(VkMemoryPropertyFlags);

template <>
inline constexpr size_t first_version_size<dermis_history> = offsetof(dermis_history, text) +
                                                             sizeof(const char*);

inline size_t stated_size(const void* structure) {
  size_t size = 0;
  std::memcpy(&size, structure, sizeof size);
  return size;
}

template <class T> SizedRead check_size(size_t size) {
  static_assert(first_version_size<T> >= sizeof(size_t));
  if (size < first_version_size<T>) return SizedRead::too_small;
  return size > largest_struct_size ? SizedRead::too_large : SizedRead::ok;
}

// `to` holds the defaults when called. `from` need not be aligned.
template <class T> SizedRead read_sized(const void* from, T& to) {
  const size_t size = stated_size(from);
  if (const SizedRead checked = check_size<T>(size); checked != SizedRead::ok) return checked;
  const auto* bytes = static_cast<const std::byte*>(from);
  for (size_t i = sizeof(T); i < size; ++i)
    if (bytes[i] != std::byte{0}) return SizedRead::unknown_fields;
  std::memcpy(&to, bytes, std::min(size, sizeof(T)));
  to.struct_size = sizeof(T);
  return SizedRead::ok;
}

// Writes what the caller has room for; fields of the caller that we do not know become zero.
template <class T> void write_sized(void* to, size_t size, T value) {
  value.struct_size = size;
  auto* bytes = static_cast<std::byte*>(to);
  std::memcpy(bytes, &value, std::min(size, sizeof(T)));
  if (size > sizeof(T)) std::memset(bytes + sizeof(T), 0, size - sizeof(T));
}

} // namespace dermis::abi
