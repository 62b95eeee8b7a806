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
#include "afis/afis.glsl"
#include "common/tile_edges.glsl"

// The ramp covers the whole tile, because replaced light differs by more than blended light.
const float ramp_px = 8.0;

void main() {
  ivec2 pixel;
  bool copy_only;
  if (!listed_pixel(pixel, copy_only))
    return;
  ivec2 texel = texel_of(pixel), tile = pixel >> 3;
  uint id = texelFetch(material_image, texel, 0).r;
  uint steps = samples_per_tile_data[tile.y * frame.tiles.x + tile.x];
  float depth = view_depth(texelFetch(depth_image, texel, 0).r);
  if (id == 0u || steps == 0u || depth <= 0.0)
    return;
  float scale = has_scatter_scale() ? clean_scatter_scale(texelFetch(scatter_scale_image, texel, 0).r) : 1.0;
  scatter_profile profile = find_profile(id, scale);
  if (projected_d(profile.d.w, depth) < copy_below_d_px)
    return;
  vec4 light = texelFetch(light_image, texel, 0);
  int count = settings.samples << (steps - 1u);
  vec3 sampled = scatter(scatter_point(pixel, id, depth, view_position(vec2(pixel), depth)), profile, light.a, light.rgb,
                         sample_set(0u, count, count, frame.frame_index * uint(count)));
  vec4 other = imageLoad(scattered_image, texel);
  imageStore(scattered_image, texel, vec4(round_to_half(mix(other.rgb, sampled, edge_weight(pixel, ramp_px))), other.a));
}
