// Kernels have two shapes. Texel shape, for GPUs: one texel per invocation. Block shape, for
// drivers on the CPU: one block of texels per invocation. The host sets the constant by the
// device's type (framegraph/vulkan/device.hpp).
#ifndef DERMIS_SHAPE_GLSL
#define DERMIS_SHAPE_GLSL

#ifdef DERMIS_ONE_SHAPE
// The kernel has the texel shape on every device. The constants say how lists are divided, and the
// number of invocations of a group.
layout(constant_id = 0) const bool texel_lists = true;
const bool texel_shape = true;
layout(local_size_x = 64, local_size_x_id = 3) in;
#else
layout(constant_id = 0) const bool texel_shape = true;
#endif

#endif
