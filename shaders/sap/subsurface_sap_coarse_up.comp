#version 460
// Computes level `level` of the way up and all coarser levels in one dispatch. A group computes a
// tile of `level`. Before, it computes the texels of the coarser levels on which the tile depends;
// neighbouring groups compute some of these, too, so that no group waits for another one.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "sap/subsurface_sap_coarse_up.bindings.glsl"
#include "common/environment.glsl"
#include "common/half.glsl"
#define DERMIS_ONE_SHAPE
#define SAP_WINDOW
#define SAP_OWN_LAYERS 2
#define SAP_COARSE_LAYERS 2
#include "sap/sap_climb.glsl"

void store_scattered(sap_place place, int level, int layer, uvec4 bits) {
  if (level > settings.level)
    window_scattered[level & 1][layer][place.index] = bits;
  else if (layer == 0)
    imageStore(scattered_image, sap_address(place.at, level), bits);
  else
    imageStore(second_scattered_image, sap_address(place.at, level), bits);
}
#include "sap/sap_up_layers.glsl"

// Computes a layer of texel i of a window, 0 outside the level. GPUs: an invocation computes one
// layer, because both halves of the group compute at once.
void compute_layer(sap_place place, int level, int layer, bool smooth_level, bool last) {
  uvec4 first = near_bits(place, near_centre);
  if (layer > 0 && !sap_has_second(first))
    return;
  sap_texel own = sap_unpack(layer_bits(place, near_centre, layer));
  uvec4 bits = uvec4(0u);
  if (own.id != 0u)
    bits = climb(place, level, own, layer_light(place, near_centre, layer).rgb, SAP_OWN_LAYERS,
                 smooth_level, last);
  store_scattered(place, level, layer, bits);
}

// Computes the texels of a window.
void compute_window(ivec2 tile, int w, bool last) {
  sap_window window = window_of(tile, w), coarser = window_of(tile, last ? w : w + 1);
  int level = settings.level + w;
  bool smooth_level = settings.variant == VARIANT_SMOOTH;
  uint begin = texel_lists ? gl_LocalInvocationIndex & 63u : gl_LocalInvocationIndex;
  int layer = texel_lists ? int(gl_LocalInvocationIndex >> 6u) : 0;
  [[dont_unroll]] for (int i = int(begin); i < window.side * window.side;
                       i += texel_lists ? 64 : int(group_lanes)) {
    sap_place place = place_in_window(window, coarser, w, i);
    if (!sap_inside(place.at, level)) {
      if (w > 0 && layer == 0)
        store_scattered(place, level, 0, uvec4(0u));
    } else if (texel_lists) {
      compute_layer(place, level, layer, smooth_level, last);
    } else {
      compute_layers(place, level, smooth_level, last);
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
    texel_block block =
        block_of_entry(level_tiles_data[list.x + index], 0);
    barrier(); // the last tile is complete
    read_windows(block, windows);
    [[dont_unroll]] for (int w = windows - 1; w >= 0; --w) {
      compute_window(block.tile, w, w == windows - 1);
      barrier();
    }
  }
}
