#version 460
// The last step up in the tiles that subsurface.probe selects, for graphs whose last step writes
// the host's light directly. A group handles at most one tile.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "sap/subsurface_sap_gather_probed.bindings.glsl"
#include "common/half.glsl"
#include "common/probed_tile.glsl"
#include "sap/sap_gather.glsl"

layout(local_size_x = 64, local_size_y = 1, local_size_z = 1) in;

bool stores_full() { return settings.storage == STORAGE_FULL; }
uint class_at(int tile) { return classes_data[tile]; }
uvec2 level_tiles_at(uint index) { return uvec2(0u); } // tiles do not come from a list

uvec4 read_surface(ivec2 address, int layer) { return texelFetch(surface_image, address, 0); }
vec4 read_light(ivec2 address, int layer) { return texelFetch(light_image, address, 0); }
uvec4 read_coarse_surface(ivec2 address, int layer) {
  return layer == 0 ? texelFetch(coarse_surface_image, address, 0)
                    : texelFetch(second_coarse_surface_image, address, 0);
}
uvec4 read_coarse_scattered(ivec2 address, int layer) {
  return layer == 0 ? texelFetch(coarse_scattered_image, address, 0)
                    : texelFetch(second_coarse_scattered_image, address, 0);
}
bool has_second_near(uvec4 bits) { return false; }
bool has_second_corner(uvec4 bits) {
  return sap_has_second(bits) && has_second_coarse_surface() && has_second_coarse_scattered();
}

// Returns the entry of a tile in the lists of the pyramid (sap_lists.glsl).
uvec2 entry_of(ivec2 tile) {
  uint around = 0u;
  for (int i = 0; i < 9; ++i) {
    ivec2 near = tile + ivec2(i % 3, i / 3) - 1, inside = clamp(near, ivec2(0), frame.tiles - 1);
    bool written = near == inside &&
                   class_of_tile(class_at(inside.y * frame.tiles.x + inside.x)) != class_none;
    around |= written ? 1u << uint(i) : 0u;
  }
  return uvec2(pack_tile(uvec2(tile), class_at(tile.y * frame.tiles.x + tile.x)), around << 9);
}

void main() {
  probed_tile selected;
  if (!find_probed_tile(settings.tiles, settings.interval, selected))
    return;
  int part = int(gl_LocalInvocationIndex), across = 8 / pixel_blocks.size.x;
  if (!texel_shape && part >= across * (8 / pixel_blocks.size.y)) // a tile has fewer blocks
    return;
  ivec2 offset = texel_shape ? ivec2(part & 7, part >> 3)
                             : ivec2(part % across, part / across) * pixel_blocks.size;
  texel_block block = block_of_entry(entry_of(position_of_tile(selected.tile)), offset);
  if (block.copy_only) // the picture shows its own light
    return;
  read_ring(block, pixel_blocks, 0, 1, true);
  read_coarser(block, pixel_blocks, 0, 2);
  finish_reading();
  [[unroll]] for (int k = 0; k < block_texels(pixel_blocks); ++k) {
    sap_place place = place_of(block, pixel_blocks, k, 0);
    if (!inside_rect(place.at))
      continue;
    vec4 light = near_light(place, 0, ivec2(0), 0);
    vec4 result = vec4(light.rgb, 1.0);
    sap_texel own = sap_unpack(near_surface(place, ivec2(0), 0));
    if (own.id != 0u)
      result = gather(place, own, light, settings.variant);
    imageStore(scattered_image, texel_of(place.at), stores_full() ? result : round_to_half(result));
  }
}
