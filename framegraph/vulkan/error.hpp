#pragma once
// What went wrong on a device, as a value: a kind to act on, the Vulkan result, and a text that names call
// and thing.

#include <string>
#include <utility>
#include <vulkan/vulkan_core.h>

namespace dermis::vulkan {

enum class ErrorKind : uint8_t {
  none,
  argument,      // the caller gave something that does not fit the plan
  unsupported,   // the device lacks something
  shader,        // a kernel does not fit its signature
  host_memory,   // VK_ERROR_OUT_OF_HOST_MEMORY
  device_memory, // VK_ERROR_OUT_OF_DEVICE_MEMORY
  device_lost,
  vulkan // any other failure of a call
};

struct Error {
  ErrorKind kind = ErrorKind::none;
  VkResult result = VK_SUCCESS; // of the call that failed, VK_SUCCESS when it was not a call
  std::string text;             // "vkAllocateMemory failed (VK_ERROR_OUT_OF_DEVICE_MEMORY): heap 0 of 4 MiB"

  explicit operator bool() const { return kind != ErrorKind::none; } // true: there is an error
};

// "VK_ERROR_DEVICE_LOST"; static string, "VkResult" for numbers it does not know. Free-threaded.
const char* result_name(VkResult result);
// The kind that a failed call belongs to; none for VK_SUCCESS. Free-threaded.
ErrorKind kind_of(VkResult result);
// The error of a failed call on `thing`; no error when `result` is VK_SUCCESS. Free-threaded.
Error call_error(VkResult result, const char* call, const std::string& subresource);

} // namespace dermis::vulkan
