// Takes the place of common/shape.glsl in kernels that have the texel shape on every device. The
// constants say how lists are divided, and the number of invocations of a group: with
// DERMIS_WIDE_GROUP 512 on GPUs that allow as many.
#ifndef DERMIS_ONE_SHAPE_GLSL
#define DERMIS_ONE_SHAPE_GLSL

layout(constant_id = 0) const bool texel_lists = true;
const bool texel_shape = true;
#ifdef DERMIS_WIDE_GROUP
layout(constant_id = 5) const bool wide_group = true;
layout(local_size_x = 64, local_size_x_id = 6) in;
#else
layout(local_size_x = 64, local_size_x_id = 3) in;
#endif

#endif
