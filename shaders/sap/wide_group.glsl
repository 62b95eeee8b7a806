// Groups of 512 invocations on GPUs that allow as many; else of the size that the host sets.
#ifndef DERMIS_WIDE_GROUP_GLSL
#define DERMIS_WIDE_GROUP_GLSL

layout(constant_id = 5) const bool wide_group = true;
layout(local_size_x = 64, local_size_x_id = 6) in;

#endif
