#version 460
#extension GL_EXT_samplerless_texture_functions : require
// Writes the image for the slot `material` (r8_uint): profile ids from a bit field of an integer
// G-buffer image, or from stencil. See docs/integration.md, "Profile ids from other images".
layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0) uniform utexture2D source; // a stencil view also works here
layout(set = 0, binding = 1) uniform writeonly uimage2D material;
layout(push_constant) uniform Field { int first_bit, bits; } field; // first_bit 0 is the lowest

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(material)))) return;
  uint packed_value = texelFetch(source, pixel, 0).r;
  imageStore(material, pixel, uvec4(bitfieldExtract(packed_value, field.first_bit, field.bits)));
}
