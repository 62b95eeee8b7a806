#include "framegraph/vulkan/error.hpp"

#include <fmt/core.h>

namespace dermis::vulkan {

const char* result_name(VkResult result) {
  switch (result) {
  case VK_SUCCESS:
    return "VK_SUCCESS";
  case VK_NOT_READY:
    return "VK_NOT_READY";
  case VK_TIMEOUT:
    return "VK_TIMEOUT";
  case VK_INCOMPLETE:
    return "VK_INCOMPLETE";
  case VK_ERROR_OUT_OF_HOST_MEMORY:
    return "VK_ERROR_OUT_OF_HOST_MEMORY";
  case VK_ERROR_OUT_OF_DEVICE_MEMORY:
    return "VK_ERROR_OUT_OF_DEVICE_MEMORY";
  case VK_ERROR_INITIALIZATION_FAILED:
    return "VK_ERROR_INITIALIZATION_FAILED";
  case VK_ERROR_DEVICE_LOST:
    return "VK_ERROR_DEVICE_LOST";
  case VK_ERROR_MEMORY_MAP_FAILED:
    return "VK_ERROR_MEMORY_MAP_FAILED";
  case VK_ERROR_FEATURE_NOT_PRESENT:
    return "VK_ERROR_FEATURE_NOT_PRESENT";
  case VK_ERROR_TOO_MANY_OBJECTS:
    return "VK_ERROR_TOO_MANY_OBJECTS";
  case VK_ERROR_FORMAT_NOT_SUPPORTED:
    return "VK_ERROR_FORMAT_NOT_SUPPORTED";
  case VK_ERROR_FRAGMENTED_POOL:
    return "VK_ERROR_FRAGMENTED_POOL";
  case VK_ERROR_OUT_OF_POOL_MEMORY:
    return "VK_ERROR_OUT_OF_POOL_MEMORY";
  case VK_ERROR_FRAGMENTATION:
    return "VK_ERROR_FRAGMENTATION";
  case VK_ERROR_INVALID_SHADER_NV:
    return "VK_ERROR_INVALID_SHADER_NV";
  case VK_ERROR_UNKNOWN:
    return "VK_ERROR_UNKNOWN";
  default:
    return "VkResult";
  }
}

ErrorKind kind_of(VkResult result) {
  switch (result) {
  case VK_SUCCESS:
    return ErrorKind::none;
  case VK_ERROR_OUT_OF_HOST_MEMORY:
    return ErrorKind::host_memory;
  case VK_ERROR_OUT_OF_DEVICE_MEMORY:
  case VK_ERROR_FRAGMENTED_POOL:
  case VK_ERROR_OUT_OF_POOL_MEMORY:
  case VK_ERROR_FRAGMENTATION:
    return ErrorKind::device_memory;
  case VK_ERROR_DEVICE_LOST:
    return ErrorKind::device_lost;
  case VK_ERROR_FORMAT_NOT_SUPPORTED:
  case VK_ERROR_FEATURE_NOT_PRESENT:
    return ErrorKind::unsupported;
  default:
    return ErrorKind::vulkan;
  }
}

Error call_error(VkResult result, const char* call, const std::string& object) {
  if (result == VK_SUCCESS) return {};
  return {kind_of(result), result,
          fmt::format("{} failed ({}, {}): {}", call, result_name(result), static_cast<int>(result),
                      object)};
}

} // namespace dermis::vulkan
