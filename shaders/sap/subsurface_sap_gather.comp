#version 460
// The last step up: writes scattered light and confidence of every listed pixel, from the nearer
// layers of level 1.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "sap/subsurface_sap_gather.bindings.glsl"
#include "common/combined_light.glsl"
#include "sap/sap_gather.glsl"

layout(local_size_x = 64, local_size_y = 1, local_size_z = 1) in;

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
  if (!listed_block(pixel_blocks, 0, gl_LocalInvocationIndex, block))
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
      result = gather(place, own, light, settings.variant);
    write_result(place.at, own, result);
  }
}
