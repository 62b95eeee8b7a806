#version 460
// Computes level `level` of the way up and all coarser levels in one dispatch. A group computes a
// tile of `level`. Before, it computes the texels of the coarser levels on which the tile depends;
// neighbouring groups compute some of these, too, so that no group waits for another one.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "sap/subsurface_sap_coarse_up.bindings.glsl"
#include "sap/sap_climb.glsl"
#include "sap/sap_levels.glsl"
#include "sap/sap_window.glsl"

layout(constant_id = 0) const bool texel_lists = true; // lists are divided as for the texel shape
layout(local_size_x = 64, local_size_x_id = 3) in;
const uint group_lanes = gl_WorkGroupSize.x;

bool stores_full() { return settings.storage == STORAGE_FULL; }
uvec2 level_tiles_at(uint index) { return level_tiles_data[index]; }

uvec4 level_surface(ivec2 address, int window, int layer) {
  if (window > 0)
    return texelFetch(levels_image,
                      place_in_levels(address, window - 1, surface_in_levels + layer), 0);
  return layer == 0 ? texelFetch(surface_image, address, 0)
                    : texelFetch(second_surface_image, address, 0);
}
vec4 level_light(ivec2 address, int window, int layer, uvec4 bits) {
  if (window > 0)
    return light_from_bits(texelFetch(
        levels_image, place_in_levels(address, window - 1, light_in_levels + layer), 0));
  return sap_stored_light(bits, layer == 0 ? texelFetch(light_image, address, 0)
                                           : texelFetch(second_light_image, address, 0));
}

void store_scattered(sap_place place, int level, int layer, uvec4 bits) {
  if (level > settings.level)
    window_scattered[level & 1][layer][place.index] = bits;
  else if (layer == 0)
    imageStore(scattered_image, sap_address(place.at, level), bits);
  else
    imageStore(second_scattered_image, sap_address(place.at, level), bits);
}

// Computes a layer of texel i of a window, 0 outside the level. GPUs: an invocation computes one
// layer, because both halves of the group compute at once.
void compute_layer(sap_step how, sap_place place, int layer) {
  uvec4 first = near_surface(place, ivec2(0), 0);
  if (layer > 0 && !sap_has_second(first))
    return;
  sap_texel own = sap_unpack(near_surface(place, ivec2(0), layer));
  uvec4 bits = uvec4(0u);
  if (own.id != 0u)
    bits = climb(how, place, own, near_light(place, how.level, ivec2(0), layer).rgb, 2);
  store_scattered(place, how.level, layer, bits);
}

// Computes the texels of a window.
void compute_window(ivec2 tile, int w, bool last) {
  sap_window window = window_of(tile, w), coarser = window_of(tile, last ? w : w + 1);
  sap_step how = sap_step(settings.level + w, settings.variant,
                          settings.variant == VARIANT_SMOOTH, last);
  uint begin = texel_lists ? gl_LocalInvocationIndex & 63u : gl_LocalInvocationIndex;
  int layer = texel_lists ? int(gl_LocalInvocationIndex >> 6u) : 0;
  [[dont_unroll]] for (int i = int(begin); i < window.side * window.side;
                       i += texel_lists ? 64 : int(group_lanes)) {
    sap_place place = place_in_window(window, coarser, w, i);
    if (!sap_inside(place.at, how.level)) {
      if (w > 0 && layer == 0)
        store_scattered(place, how.level, 0, uvec4(0u));
    } else if (texel_lists) {
      compute_layer(how, place, layer);
    } else {
      compute_layers(how, place);
    }
  }
}

void main() {
  uint tiles = texel_lists ? 1u : sap_tiles_per_group;
  int windows = sap_levels - settings.level;
  for (uint k = 0u; k < tiles; ++k) {
    uvec2 list = level_tiles_data[settings.level];
    uint index = dispatched_group() * tiles + k;
    if (index >= list.y)
      return;
    texel_block block = texel_of_entry(level_tiles_data[list.x + index], 0);
    barrier(); // the last tile is complete
    read_windows(block, settings.level, windows, int(group_lanes));
    [[dont_unroll]] for (int w = windows - 1; w >= 0; --w) {
      compute_window(block.tile, w, w == windows - 1);
      barrier();
    }
  }
}
