#pragma once

#include <cstdint>

namespace demo {

// DERMIS_CONTEXT_GPU_KERNELS or DERMIS_CONTEXT_CPU_KERNELS; by_device: neither
enum class KernelShape : uint8_t { by_device, gpu, cpu };

} // namespace demo
