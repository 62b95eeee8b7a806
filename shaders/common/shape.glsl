// A compute shader has two variants. Texel shape, for GPUs: an invocation computes one texel. Block
// shape, for software drivers: an invocation computes blocks of texels. The executor sets the
// constant according to the device's type (framegraph/vulkan/device.hpp).
#ifndef DERMIS_SHAPE_GLSL
#define DERMIS_SHAPE_GLSL

layout(constant_id = 0) const bool texel_shape = true;

#endif
