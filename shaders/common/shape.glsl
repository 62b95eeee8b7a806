// Kernels have two shapes. Texel shape, for GPUs: one texel per invocation. Block shape, for
// drivers on the CPU: one block of texels per invocation. The host sets the constant by the
// device's type (framegraph/vulkan/device.hpp).
#ifndef DERMIS_SHAPE_GLSL
#define DERMIS_SHAPE_GLSL

layout(constant_id = 0) const bool texel_shape = true;

#endif
