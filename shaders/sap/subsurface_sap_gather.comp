#version 460
// The last step up: writes scattered light and confidence of every listed pixel, from the nearer
// layers of level 1.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "sap/subsurface_sap_gather.bindings.glsl"
#include "common/combined_light.glsl"
#include "sap/sap_neighbours.glsl"

bool stores_full() { return settings.storage == STORAGE_FULL; }
uvec2 level_tiles_at(uint index) { return level_tiles_data[index]; }

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

// Texel shape: the pixels of the group, and both layers of the texels under them.
shared uvec4 tile_surface[texel_shape ? ring_texels : 1];
shared uvec2 tile_light[texel_shape ? ring_texels : 1];
shared uvec4 tile_coarse_surface[texel_shape ? 2 * coarse_under_pixels : 1];
shared uvec4 tile_coarse_scattered[texel_shape ? 2 * coarse_under_pixels : 1];
// Block shape: those of a block.
const int block_ring = (4 + 2 * ring_reach) * (2 + 2 * ring_reach);
const int block_coarse = square_pixels ? 4 * 3 : 5 * 3;
uvec4 ring_surface[block_ring];
vec4 ring_light[block_ring];
uvec4 coarse_surface[2 * block_coarse], coarse_scattered[2 * block_coarse];

void keep_texel(int i, uvec4 surface, vec4 light) {
  if (texel_shape) {
    tile_surface[i] = surface;
    tile_light[i] = uvec2(packHalf2x16(light.rg), sap_light_ba(surface));
  } else {
    ring_surface[i] = surface;
    ring_light[i] = sap_stored_light(surface, light);
  }
}
void keep_coarse(int i, uvec4 surface, uvec4 scattered) {
  if (texel_shape) {
    tile_coarse_surface[i] = surface;
    tile_coarse_scattered[i] = scattered;
  } else {
    coarse_surface[i] = surface;
    coarse_scattered[i] = scattered;
  }
}
uvec4 kept_surface(int i) { return tile_surface[i]; }
uvec2 kept_light(int i) { return tile_light[i]; }

uvec4 near_surface(sap_place place, ivec2 step, int layer) {
  int i = ring_place(pixel_blocks, place, step);
  return texel_shape ? tile_surface[i] : ring_surface[i];
}
vec4 near_light(sap_place place, int level, ivec2 step, int layer) {
  return texel_shape ? light_in_tile(pixel_blocks, place, level, step, layer)
                     : ring_light[ring_place(pixel_blocks, place, step)];
}
uvec4 corner_surface(sap_place place, int n, int layer) {
  int i = layer * coarse_texels(pixel_blocks) + corner_place(pixel_blocks, place, n);
  return texel_shape ? tile_coarse_surface[i] : coarse_surface[i];
}
uvec4 corner_scattered(sap_place place, int level, int n, int layer) {
  int i = layer * coarse_texels(pixel_blocks) + corner_place(pixel_blocks, place, n);
  return texel_shape ? tile_coarse_scattered[i] : coarse_scattered[i];
}

const float min_fraction = 0.002; // the tent is not worth its time for a smaller weight

// Returns the light of the pixel at `place`, whose own light is `centre_light`.
vec4 gather(sap_place place, sap_texel own, vec4 centre_light) {
  vec3 light = centre_light.rgb;
  // a tilted pixel keeps more of its own light
  vec3 d_px = sap_d_px(own) * inversesqrt(centre_light.a);
  vec3 centre, tent;
  sap_weights_of_level_0(own.id, settings.variant, d_px, centre, tent);
  sap_sum near = sap_sum(light, vec3(1.0));
  if (max(tent.r, max(tent.g, tent.b)) >= min_fraction)
    near = sap_tent(place, 0, own, 1);
  float confidence;
  sap_sum rest = sap_from_coarser(place, 0, own, light, 2, confidence);
  rest.mass *= max(1.0 - centre - tent, vec3(0.0));
  uint widest = profiles[min(own.id, 255u)].widest;
  confidence = mix(confidence, 1.0, centre[widest] + tent[widest]); // level 0 misses nothing
  // Light that never scatters needs no surface around.
  vec3 direct = profile_direct(own.id);
  vec3 mean = sap_blend(max(centre - direct, vec3(0.0)), light, tent * near.mass,
                        near.light, rest)
                  .light;
  return vec4(mix(mean, light, direct), confidence);
}

// Writes the result of a pixel to the bound ports.
void write_result(ivec2 pixel, sap_texel own, vec4 result) {
  ivec2 texel = texel_of(pixel);
  if (!stores_full())
    result = round_to_half(result);
  if (has_scattered())
    imageStore(scattered_image, texel, result);
  if (has_lighting() && sap_has_subsurface(own)) {
    vec3 albedo =
        combined_albedo(albedo_image, has_albedo(), settings.texturing, settings.result, texel);
    imageStore(lighting_image, texel,
               combined_light(settings.texturing, settings.result, albedo, result.rgb));
  }
  if (has_unscattered() && has_scattered_light() && own.id != 0u) {
    vec4 before = texelFetch(unscattered_image, texel, 0);
    vec3 d = profiles[min(own.id, 255u)].d_mm.rgb;
    if (before.a == 0.0)
      imageStore(scattered_light_image, texel,
                 vec4(mix(before.rgb, result.rgb, greaterThan(d, vec3(0.0))), 1.0));
  }
}

void main() {
  texel_block block;
  if (!listed_block(pixel_blocks, 0, block))
    return;
  read_ring(block, pixel_blocks, 0, 1, !block.copy_only);
  if (!block.copy_only)
    read_coarser(block, pixel_blocks, 0, 2);
  finish_reading();
  [[unroll]] for (int k = 0; k < block_texels(pixel_blocks); ++k) {
    sap_place place = place_of(block, pixel_blocks, k, 0);
    if (!inside_rect(place.at))
      continue;
    vec4 light = near_light(place, 0, ivec2(0), 0);
    vec4 result = vec4(light.rgb, 1.0);
    sap_texel own = sap_unpack(near_surface(place, ivec2(0), 0));
    if (!block.copy_only && own.id != 0u)
      result = gather(place, own, light);
    write_result(place.at, own, result);
  }
}
