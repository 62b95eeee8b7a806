#version 460
// Computes level 1 of the surface-aware pyramid directly from the view, from those of 2x2 pixels
// that lie on one surface. Level 0 is not stored. Patches ignore pixels beyond those of a block of
// 2x2 texels.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "sap/subsurface_sap_setup_half_res.bindings.glsl"
#include "common/pixel_light.glsl"
#include "sap/sap_blocks.glsl"
#include "sap/sap_ordered_sums.glsl"
#include "sap/sap_pixel_block.glsl"

layout(local_size_x = 64, local_size_y = 1, local_size_z = 1) in;

bool stores_full() { return settings.storage == STORAGE_FULL; }
uvec2 level_tiles_at(uint index) { return level_tiles_data[index]; }

// The pixels of the invocation's block, or in the texel shape of the group's tile.
const int side = 4, tile_pixels = 16;
pixel_rows read_rows() {
  return pixel_rows(texel_shape ? tile_pixels : side, 2 * step_from_level(0));
}
uint block_profile[side * side];
float block_depth[side * side];
shared uint tile_profile[texel_shape ? tile_pixels * tile_pixels : 1];
shared float tile_depth[texel_shape ? tile_pixels * tile_pixels : 1];
uint profile_at(int i) { return texel_shape ? tile_profile[i] : block_profile[i]; }
float depth_at(int i) { return texel_shape ? tile_depth[i] : block_depth[i]; }

// Block shape: the children of a block. Both shapes: those of a parent.
const int parent_children = 4;
sap_texel block_children[side * side], children[parent_children];
vec4 block_light[side * side], child_light[parent_children];
int children_across() { return 2; }
bool shares_children() { return false; }
bool finer_has_layers() { return false; }
sap_texel child_of(sap_parent parent, int c, bool second) { return children[c]; }
vec4 light_of(sap_parent parent, int c, bool second, uint id) { return child_light[c]; }

void read_pixel(texel_block block, int i, ivec2 pixel) {
  ivec2 tile = (pixel >> 3) - step_from_level(0) * block.tile + 1, texel = texel_of(pixel);
  bool needed = inside_rect(pixel) && tile_written(block.children, tile);
  uint id = needed ? profile_of(texelFetch(material_image, texel, 0).r) : 0u;
  float depth = id != 0u ? view_depth(texelFetch(depth_image, texel, 0).r) : 0.0;
  if (texel_shape) {
    tile_profile[i] = id;
    tile_depth[i] = depth;
  } else {
    block_profile[i] = id;
    block_depth[i] = depth;
  }
}
// Texel shape: reads the pixels of the tile.
void read_tile(texel_block block) {
  [[dont_unroll]] for (int i = int(gl_LocalInvocationIndex); i < tile_pixels * tile_pixels; i += 64)
    read_pixel(block, i,
               step_from_level(0) * (8 * block.tile - 1) +
                   ivec2(i % tile_pixels, i / tile_pixels));
  barrier();
}
void compute_child(ivec2 pixel, ivec2 place, out sap_texel child, out vec4 light) {
  int i = pixel_index(read_rows(), place);
  child = no_texel;
  light = vec4(0.0);
  if (profile_at(i) != 0u && depth_at(i) > 0.0) {
    child = surface_at(scatter_scale_image, has_scatter_scale(), read_rows(), pixel, place,
                       light.a);
    uint bits = sap_with_low_bits(floatBitsToUint(child.depth), sap_max_held, sap_max_held);
    child.depth = uintBitsToFloat(bits); // a pixel represents its whole surface
    light.rgb = pixel_light(lighting_image, albedo_image, has_albedo(), settings.texturing,
                            texel_of(pixel));
  }
}
// Block shape: reads the pixels of a block and computes all children.
void read_block(texel_block block, ivec2 first) {
  [[unroll]] for (int i = 0; i < side * side; ++i)
    read_pixel(block, i, step_from_level(0) * first + ivec2(i % side, i / side));
  [[unroll]] for (int i = 0; i < side * side; ++i) {
    ivec2 place = ivec2(i % side, i / side);
    compute_child(step_from_level(0) * first + place, place, block_children[i], block_light[i]);
  }
}

void main() {
  texel_block block;
  if (!listed_block(texel_blocks, 1, gl_LocalInvocationIndex, block))
    return;
  ivec2 first = block.first - 1;
  if (texel_shape)
    read_tile(block);
  else
    read_block(block, first);
  [[unroll]] for (int k = 0; k < block_texels(texel_blocks); ++k) {
    sap_parent parent = parent_at(first + block_offset(texel_blocks, k), 0);
    parent.splits = false;
    if (!sap_inside(parent.at, 1))
      continue;
    [[unroll]] for (int c = 0; c < parent_children; ++c) {
      ivec2 child = place_of_child(c);
      if (texel_shape) {
        compute_child(step_from_level(0) * parent.at + child,
                      step_from_level(0) * (block.first - 8 * block.tile) + child, children[c],
                      child_light[c]);
      } else {
        children[c] = block_children[shared_child(k, c, 0)];
        child_light[c] = block_light[shared_child(k, c, 0)];
      }
    }
    sap_layer layer = reduce(parent, 1, no_texel);
    imageStore(coarse_light_image, sap_address(parent.at, 1), layer.light);
    imageStore(coarse_surface_image, sap_address(parent.at, 1), layer.bits);
  }
}
