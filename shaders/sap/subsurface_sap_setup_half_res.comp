#version 460
// Computes level 1 of the surface-aware pyramid directly from the view, from those of 2x2 pixels
// that lie on one surface. Level 0 is not stored. An invocation reads the 4x4 pixels of its texels
// once; patches ignore pixels beyond them.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "sap/subsurface_sap_setup_half_res.bindings.glsl"
#include "common/environment.glsl"
#include "common/half.glsl"
#define SAP_BOX
#include "sap/sap_down.glsl"
sap_texel block_children[side * side];
vec4 block_light[side * side];
const int pixels_across = side, pixels_down = side;
#include "sap/sap_pixel_block.glsl"

void read_pixels(texel_block block, ivec2 first) {
  [[unroll]] for (int i = 0; i < side * side; ++i) {
    ivec2 pixel = 2 * first + ivec2(i % side, i / side), texel = texel_of(pixel);
    uint id = 0u;
    float depth = 0.0;
    if (inside_rect(pixel) && tile_written(block.children, (pixel >> 3) - 2 * block.tile + 1))
      id = texelFetch(material_image, texel, 0).r;
    if (id != 0u)
      depth = view_depth(texelFetch(depth_image, texel, 0).r);
    pixel_profile[i] = id;
    pixel_depth[i] = depth;
  }
  [[unroll]] for (int i = 0; i < side * side; ++i) {
    ivec2 pixel = 2 * first + ivec2(i % side, i / side);
    block_children[i] = sap_texel(0.0, vec2(0.0), 0.0, 0.0, 0u);
    block_light[i] = vec4(0.0);
    if (pixel_profile[i] != 0u && pixel_depth[i] > 0.0) {
      block_children[i] = block_surface(pixel, i, block_light[i].a);
      block_light[i].rgb = pixel_light(lighting_image, albedo_image, has_albedo(),
                                       settings.texturing, texel_of(pixel));
    }
  }
}

void main() {
  texel_block block;
  if (!listed_block(1, block))
    return;
  ivec2 first = block.first - 1;
  read_pixels(block, first);
  [[unroll]] for (int k = 0; k < block_width * block_height; ++k) {
    ivec2 at = first + ivec2(k % block_width, k / block_width);
    if (!sap_inside(at, 1))
      continue;
    [[unroll]] for (int c = 0; c < children_a_layer; ++c) {
      children[c] = block_children[shared_child(k, c)];
      child_light[c] = block_light[shared_child(k, c)];
    }
    begin_parent(1);
    vec4 light;
    uvec4 bits;
    reduce(1.0, 1, light, bits);
    imageStore(coarse_light_image, sap_address(at, 1), stored(light));
    imageStore(coarse_surface_image, sap_address(at, 1), bits);
  }
}
