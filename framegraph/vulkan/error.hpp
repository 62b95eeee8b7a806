#pragma once
// Describes a device failure as a value: a kind to act on, the Vulkan result, and a text that names
// the call and the object.

#include <string>
#include <utility>
#include <vulkan/vulkan_core.h>

namespace dermis::vulkan {

enum class ErrorKind : uint8_t {
  none,
  argument,      // the caller's input does not fit the plan
  allocator,     // the host's allocator returned memory that cannot be used
  unsupported,   // the device lacks something
  shader,        // a kernel does not fit its signature
  host_memory,   // VK_ERROR_OUT_OF_HOST_MEMORY
  device_memory, // VK_ERROR_OUT_OF_DEVICE_MEMORY
  device_lost,
  vulkan // any other failed call
};

struct Error {
  ErrorKind kind = ErrorKind::none;
  VkResult result = VK_SUCCESS; // result of the failed call; VK_SUCCESS if no call failed
  // e.g. "vkAllocateMemory failed (VK_ERROR_OUT_OF_DEVICE_MEMORY, -2): heap 0 of 4 MiB"
  std::string text;

  explicit operator bool() const { return kind != ErrorKind::none; } // true: there is an error
};

// Returns the name of a result, e.g. "VK_ERROR_DEVICE_LOST", or "VkResult" for unknown values. The
// string is static. Free-threaded.
const char* result_name(VkResult result);
// Returns the kind of error that a failed call belongs to; none for VK_SUCCESS. Free-threaded.
ErrorKind kind_of(VkResult result);
// Returns the error of a failed call on `object`; no error if `result` is VK_SUCCESS.
// Free-threaded.
Error call_error(VkResult result, const char* call, const std::string& object);

} // namespace dermis::vulkan
