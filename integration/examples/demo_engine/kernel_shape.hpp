#pragma once

#include <cstdint>

namespace demo {

// DERMIS_CONTEXT_GPU_KERNELS or DERMIS_CONTEXT_CPU_KERNELS; by_device: neither; gpu_small: also
// DERMIS_CONTEXT_SMALL_GROUPS
enum class KernelShape : uint8_t { by_device, gpu, gpu_small, cpu };

} // namespace demo
