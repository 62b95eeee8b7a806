// The shape of a kernel: true: for GPUs, one texel per invocation; false: for drivers on the CPU,
// one block of texels per invocation. The host sets the constant for the device
// (framegraph/vulkan/device.hpp).
#ifndef DERMIS_SHAPE_GLSL
#define DERMIS_SHAPE_GLSL

layout(constant_id = 0) const bool texel_shape = true;

#endif
