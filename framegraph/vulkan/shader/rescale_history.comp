#version 460
// Copies one mip of a history into an image of another size. Takes the nearest texel, because
// depths and profile ids must not be interpolated. RESCALE_UNSIGNED selects unsigned components
// instead of float.
#extension GL_EXT_samplerless_texture_functions : require
layout(local_size_x = 8, local_size_y = 8) in;
#ifdef RESCALE_UNSIGNED
layout(set = 0, binding = 0) uniform utexture2DArray source;
layout(set = 0, binding = 1) uniform writeonly uimage2DArray target;
#else
layout(set = 0, binding = 0) uniform texture2DArray source;
layout(set = 0, binding = 1) uniform writeonly image2DArray target;
#endif
layout(push_constant) uniform push_block { uvec2 source_size, target_size; uint mip; };

void main() {
  uvec3 texel = gl_GlobalInvocationID;
  if (any(greaterThanEqual(texel.xy, target_size))) return;
  // floor((x + 0.5) * old / new)
  uvec2 nearest = (2u * texel.xy + 1u) * source_size / (2u * target_size);
  imageStore(target, ivec3(texel), texelFetch(source, ivec3(nearest, texel.z), int(mip)));
}
