// Patches of a group of 8x8 pixels, from texels read once into shared memory.
#ifndef DERMIS_SHARED_PATCH_GLSL
#define DERMIS_SHARED_PATCH_GLSL

#extension GL_EXT_samplerless_texture_functions : require

#include "common/patch.glsl"

const int patch_side = 10; // 8x8 pixels and a ring around them
shared uint patch_profile[patch_side * patch_side];
shared float patch_depth[patch_side * patch_side]; // mm; 0 if nothing is visible

// Reads the texels around the group with first pixel `first`, each once. Every invocation of the
// group must call this.
void share_patches(utexture2D material, texture2D depth, ivec2 first) {
  for (int i = int(gl_LocalInvocationIndex); i < patch_side * patch_side; i += 64) {
    ivec2 pixel = first + ivec2(i % patch_side, i / patch_side) - 1, texel = texel_of(pixel);
    uint id = inside_rect(pixel) ? profile_of(texelFetch(material, texel, 0).r) : 0u;
    patch_profile[i] = id;
    patch_depth[i] = id != 0u ? view_depth(texelFetch(depth, texel, 0).r) : 0.0;
  }
  barrier();
}
int patch_index(ivec2 offset) {
  ivec2 local = ivec2(gl_LocalInvocationID.xy) + 1 + offset;
  return local.y * patch_side + local.x;
}
uint own_profile() { return patch_profile[patch_index(ivec2(0))]; }
float own_depth() { return patch_depth[patch_index(ivec2(0))]; }

float depth_of_profile(ivec2 offset, uint id) {
  int index = patch_index(offset);
  return patch_profile[index] == id ? patch_depth[index] : 0.0;
}

// Builds the patch of the invocation's own pixel; call share_patches first.
surface_patch build_patch(ivec2 pixel) {
  uint id = own_profile();
  return build_patch(
      pixel, own_depth(),
      patch_neighbours(vec2(depth_of_profile(ivec2(-1, 0), id), depth_of_profile(ivec2(0, -1), id)),
                       vec2(depth_of_profile(ivec2(1, 0), id), depth_of_profile(ivec2(0, 1), id))));
}

#endif
