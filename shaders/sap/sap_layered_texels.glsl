// Texels of a tile that involve second layers, collected by the group. Drivers on the CPU execute
// the code for second layers in all invocations of a vector if one needs it, so kernels compute
// these texels together, after the others. On GPUs the texels of a subgroup are computed at once.
#ifndef DERMIS_SAP_LAYERED_TEXELS_GLSL
#define DERMIS_SAP_LAYERED_TEXELS_GLSL

const bool collects_layered = !wide_group;
shared uint layered_texels[collects_layered ? 64 : 1];
shared uint layered_count;

// Every invocation of the group must call the function.
void begin_layered_texels() {
  if (collects_layered) {
    barrier(); // the texels of the last tile are computed
    if (gl_LocalInvocationIndex == 0u)
      layered_count = 0u;
    barrier();
  }
}
void collect_layered_texel(int i) { layered_texels[atomicAdd(layered_count, 1u)] = uint(i); }

#endif
