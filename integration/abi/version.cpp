#include "integration/include/dermis/dermis.h"

extern "C" uint32_t DERMIS_CALL dermis_version(void) {
  return (DERMIS_VERSION_MAJOR << 22) | (DERMIS_VERSION_MINOR << 12) | DERMIS_VERSION_PATCH;
}

extern "C" const char* DERMIS_CALL dermis_result_name(dermis_result result) {
  switch (static_cast<int>(result)) {
  case DERMIS_OK:
    return "DERMIS_OK";
  case DERMIS_ERROR_ARGUMENT:
    return "DERMIS_ERROR_ARGUMENT";
  case DERMIS_ERROR_VERSION:
    return "DERMIS_ERROR_VERSION";
  case DERMIS_ERROR_CONFIG:
    return "DERMIS_ERROR_CONFIG";
  case DERMIS_ERROR_SHADER:
    return "DERMIS_ERROR_SHADER";
  case DERMIS_ERROR_UNSUPPORTED:
    return "DERMIS_ERROR_UNSUPPORTED";
  case DERMIS_ERROR_MEMORY:
    return "DERMIS_ERROR_MEMORY";
  case DERMIS_ERROR_DEVICE_MEMORY:
    return "DERMIS_ERROR_DEVICE_MEMORY";
  case DERMIS_ERROR_VULKAN:
    return "DERMIS_ERROR_VULKAN";
  case DERMIS_ERROR_DEVICE_LOST:
    return "DERMIS_ERROR_DEVICE_LOST";
  case DERMIS_ERROR_INTERNAL:
    return "DERMIS_ERROR_INTERNAL";
  case DERMIS_INCOMPLETE:
    return "DERMIS_INCOMPLETE";
  case DERMIS_NOT_READY:
    return "DERMIS_NOT_READY";
  default:
    return "DERMIS_UNKNOWN";
  }
}
