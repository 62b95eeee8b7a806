#version 460
// Filtered importance sampling in the tiles that have samples; the result replaces the light of
// another technique. Towards tiles without samples, the weight of the other technique rises to 1,
// so that no seams appear.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_samplerless_texture_functions : require
#include "afis/subsurface_afis_tiles.bindings.glsl"
#include "common/environment.glsl"
#include "common/tiles.glsl"
#include "common/half.glsl"
#include "common/radius.glsl"
#include "afis/afis.glsl"
#include "common/tile_edges.glsl"

vec3 scatter_light(scatter_point point, scatter_profile profile, vec4 own, sample_set set) {
  afis_settings chosen = afis_settings(settings.lod_bias, settings.sequence, settings.channels,
                                       settings.inverse, settings.weighting, settings.surface,
                                       settings.direct, settings.estimator, settings.mips);
  return scatter(chosen, set, point, profile, own, material_image, depth_image, slope_image,
                 light_image, levels_image);
}

void main() {
  ivec2 pixel;
  bool copy_only;
  uint listed = listed_tile();
  if (listed >= tiles_data[0] || !pixel_of_tile(tiles_data[1u + listed], pixel, copy_only))
    return;
  ivec2 texel = texel_of(pixel), tile = pixel >> 3;
  uint id = profile_of(texelFetch(material_image, texel, 0).r);
  uint steps = samples_per_tile_data[tile.y * frame.tiles.x + tile.x];
  if (id == 0u || steps == 0u)
    return;
  float depth = view_depth(texelFetch(depth_image, texel, 0).r);
  float scale =
      has_scatter_scale() ? clean_scatter_scale(texelFetch(scatter_scale_image, texel, 0).r) : 1.0;
  scatter_profile profile = find_profile(id, scale);
  vec4 light = texelFetch(light_image, texel, 0);
  vec3 sampled = light.rgb;
  if (depth > 0.0 && projected_d(profile.d.w, depth) >= copy_below_d_px) {
    int count = settings.samples << (steps - 1u);
    scatter_point point = scatter_point(pixel, id, depth, view_position(vec2(pixel), depth));
    sample_set set = sample_set(0u, count, count, frame.frame_index * uint(count));
    sampled = scatter_light(point, profile, light, set);
  }
  uint sampled_tiles = 0u;
  for (int i = 0; i < edge_tiles; ++i) {
    int at = edge_tile(tile, i);
    sampled_tiles |= has_samples(classes_data[at], samples_per_tile_data[at]) ? 1u << uint(i) : 0u;
  }
  float fraction = edge_weight(sampled_tiles, pixel, replaced_ramp_px);
  // The other technique did not run where all tiles around have samples.
  if (fraction < 1.0)
    sampled = mix(imageLoad(scattered_image, texel).rgb, sampled, fraction);
  imageStore(scattered_image, texel, vec4(round_to_half(sampled), 1.0));
}
